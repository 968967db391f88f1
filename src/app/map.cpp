#include "app/map.hpp"

#include <utility>

#include "app/evaluate.hpp"

namespace gear3k::app {

Map map(const MapRequest& request) {
  Notes notes;
  const design::Design design =
      request.model ? with_model_on_grid(request.design, *request.model, notes) : request.design;
  design::OperatingMap map = operating_map(design, request.source);
  map.notes.insert(map.notes.end(), notes.begin(), notes.end());
  return {.map = std::move(map), .model_notes = std::move(notes)};
}

}  // namespace gear3k::app
