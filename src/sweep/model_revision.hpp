#pragma once
// The number of the models behind the results of a sweep.

namespace gear3k::sweep {

/// Raised by one whenever the result of a task may have changed: physics, checks, defaults of keys,
/// the search.  Tasks of an older revision stay in a database and are done anew when they are asked
/// for again.  The case ModelRevision.ResultsOfTheGuardAreThoseOfThisRevision says when.
inline constexpr int kModelRevision = 2;

}  // namespace gear3k::sweep
