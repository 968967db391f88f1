#pragma once
// What is expected of a run before it shows it: the numbers of optimize/run_forecast.cpp.

#include <cstddef>

#include "optimize/progress.hpp"

namespace gear3k::optimize {

/// What is expected of a run before it shows it, and by what factor it may be more or less.
struct Foreseen {
  double expected, factor;
};

// A number with a range in brackets beside it was measured, on the first nine tasks of
// benchmarks/time_left and the first ten of its --fresh ones (docs/peers.md, "The time left"); the
// number itself was chosen with that in sight.  All others, and every factor, were chosen so that
// what is told of these tasks comes near: no measurement is behind them, and other tasks may be
// farther off.

/// Over bounding a stage of the first kind that has a design: refining a set (2 to 16), sharpening
/// a bound (40 to 150), and a stage of the second kind (0.3 to 0.8).
inline constexpr double kRefining = 6.0, kSharpening = 110.0, kSecondStage = 0.55;
/// A stage without a design, over one with a design, before looks tell them apart (0 to 0.7), and
/// the share of the stages so far as which that counts: chosen.
inline constexpr double kEmptyStage = 0.2, kEmptyCountsAs = 0.02;
/// What the rest of bounding may be off by: chosen.
inline constexpr double kBoundingFactor = 1.5;
/// Sets and bounds that count as done at that: chosen.
inline constexpr double kSetsExpected = 5.0, kBoundsExpected = 1.0;
/// Of the sets whose stages have a design those to refine (0.92 to 1): pairs of modules rule out
/// others.
inline constexpr Foreseen kOpen{.expected = 0.8, .factor = 1.5};
/// Of a search for the best alone: sets refined (0 to 159, 16 to 64 are foreseen), bounds sharpened
/// (6 to 159), where modules of lists are tied, whose bounds are nearer (1).
inline constexpr Foreseen kSetsOfBest{.expected = 32.0, .factor = 2.0};
inline constexpr Foreseen kSharpened{.expected = 10.0, .factor = 4.0};
inline constexpr Foreseen kSharpenedTied{.expected = 1.5, .factor = 4.0};
/// Of the proof of the best of a number of planets: sets refined (27 to 32).
inline constexpr Foreseen kSetsOfPlanets{.expected = 30.0, .factor = 1.5};
/// Sets as many as which the share of them whose bounds are sharpened counts, before a search tells
/// it: chosen.
inline constexpr double kShareCountsAs = 16.0;
/// The share for a number of planets over that for the one before: the more, the fewer sets of
/// theirs are near their best (0.2 to 0.7).
inline constexpr double kShareOfNext = 0.6;
inline const Foreseen& sharpened(const Progress::Plan& plan) {
  return plan.ties ? kSharpenedTied : kSharpened;
}
inline double share_sharpened(const Progress::Plan& plan) {
  return sharpened(plan).expected / kSetsOfBest.expected;
}
/// Sets as many as which it costs to tell what holds the best of a number of planets back (1 to 5).
inline constexpr double kHeldBack = 3.0;
/// Sets that rounding costs: chosen.
inline constexpr Foreseen kRounding{.expected = 30.0, .factor = 2.0};
/// What is built after the passes for built gearboxes, over a pass, before any is built (8, by one
/// task).
inline constexpr Foreseen kBuiltAfter{.expected = 4.0, .factor = 2.0};
/// Sets refined as many as which a search of a front takes, at its ends or in its gaps.  A narrow
/// limit on lost motion leaves many sets without a design, and finding none costs some ten times
/// finding one (490 to 590).  Where a third objective is limited too, its bounds leave most of them
/// out (85 to 190); without lost motion few are left (25 to 50, of tasks outside of the nine).
inline constexpr Foreseen kLostMotionAlone{.expected = 500.0, .factor = 3.0};
inline constexpr Foreseen kLostMotionAndOthers{.expected = 130.0, .factor = 2.5};
inline constexpr Foreseen kWithoutLostMotion{.expected = 40.0, .factor = 2.5};
inline const Foreseen& front_search(const Progress::Plan& plan) {
  if (!plan.front_lost_motion) return kWithoutLostMotion;
  return plan.front_objectives > 2 ? kLostMotionAndOthers : kLostMotionAlone;
}
/// Ends of a front as many as which what is expected of a search counts when all are made: chosen.
inline constexpr double kExpectedAsEnds = 2.0;
/// Searches in the gaps, over the designs asked for: most of them may be known before (0.7 to
/// 0.95).
inline constexpr double kInGaps = 0.8;
/// What a search in the gaps takes may be more or less than one at the ends by (0.5 to 2.8 of it).
inline constexpr double kGapsOverEnds = 2.5;
/// Searches in the gaps as many as which the ends count; after twice as many the rest costs this
/// share of those so far, as what they found bounds the others: chosen.
inline constexpr double kEndsCountAs = 4.0, kLaterInGaps = 0.6;
/// Standard deviation of what a search in the gaps takes, over its mean, before they show it (1.2
/// to 1.9), and the greatest factor that follows from it: chosen.
inline constexpr double kScatter = 1.5, kMostScatter = 5.0;
/// Whole searches with ranges or limits given way: where there is a design (one or two, of 0.5
/// to 1.3 of finding the sets; none with more than kMostSearchedAgain sets or robust limits), and
/// where there is none (25).
inline constexpr Foreseen kBeyond{.expected = 1.2, .factor = 1.5};
inline constexpr Foreseen kRelaxed{.expected = 15.0, .factor = 3.0};
/// Searches for each limit left out, and items that count as done at it: chosen.
inline constexpr double kForLimit = 2.5, kItemsExpected = 4.0;
/// What takes longer than expected goes on for this part of the time that it took: chosen.
inline constexpr double kGoesOn = 1.0 / 3.0;
/// A search for the best alone that has refined more than is expected at most goes by its rate.
inline constexpr auto kSetsKnown =
    static_cast<std::size_t>(kSetsOfBest.expected * kSetsOfBest.factor);
/// A range whose ends are no farther apart is told as its middle: chosen.
inline constexpr double kOneNumber = 2.5;
/// One whose ends are farther apart is told as its greater end: chosen.
inline constexpr double kOneBound = 16.0;
/// Any other range is told as this factor about its middle: a wider one says little.
inline constexpr double kHalfToldRange = 2.0;

}  // namespace gear3k::optimize
