#include "pipelines/report/engine_style.h"

namespace softgrain::report {
namespace {

struct Known {
  const char* engine;
  const char* name;
  const char* color;
  const char* dash;
  Marker marker;
};

constexpr Known kKnown[] = {
    {"law", "soft particles with the fitted law", palette::blue, "", Marker::circle},
    {"pair", "pair law", palette::blue, "", Marker::circle},
    {"bag", "bag law", palette::purple, "", Marker::diamond},
    {"directional", "directional law", palette::black, "", Marker::hollow},
    {"shelled", "resolved twin (shelled)", palette::vermillion, "6 3", Marker::square},
    {"free", "resolved twin (free)", palette::orange, "2 3", Marker::triangle},
};

const Known* find(const std::string& engine) {
  for (const Known& k : kKnown)
    if (engine == k.engine) return &k;
  return nullptr;
}

}  // namespace

std::string engine_name(const std::string& engine) {
  const Known* known = find(engine);
  return known != nullptr ? known->name : engine;
}

SeriesStyle engine_style(const std::string& engine) {
  const Known* known = find(engine);
  if (known == nullptr) return {.color = palette::green, .width = 1.5, .marker = Marker::triangle, .marker_size = 2.6};
  return {.color = known->color, .width = 1.5, .dash = known->dash, .marker = known->marker, .marker_size = 2.6};
}

}  // namespace softgrain::report
