#include <grapeshot/scf/reference/settings.hpp>

#include <cmath>
#include <string>

#include <grapeshot/core/error.hpp>

namespace grapeshot::scf::reference {

namespace {

/// Written so that a NaN fails.
template <class Number>
void require(bool holds, const char* field, Number value, const char* range) {
    if (!holds) {
        throw Error(Fault::badSetting, std::string(field) + " is " + std::to_string(value) + ", not " + range,
                    "settings");
    }
}

}  // namespace

Settings withoutHierarchy() {
    Settings settings;
    settings.hierarchyShare = 0;
    return settings;
}

Settings withHierarchy() {
    return {};
}

void requireUsable(const Settings& s) {
    require(s.newPairs >= 0 && s.newPairs <= 1'000'000, "newPairs", s.newPairs, "0 to 1e6");
    require(s.velocityShare >= 0 && s.velocityShare <= 1, "velocityShare", s.velocityShare, "0 to 1");
    require(s.hierarchyShare >= 0 && s.hierarchyShare <= 1, "hierarchyShare", s.hierarchyShare, "0 to 1");
    require(s.velocityShare + s.hierarchyShare <= 1, "velocityShare + hierarchyShare",
            s.velocityShare + s.hierarchyShare, "at most 1");
    require(s.hierarchyDepth >= 0 && s.hierarchyDepth <= 16, "hierarchyDepth", s.hierarchyDepth, "0 to 16");
    require(s.tries >= 1 && s.tries <= 64, "tries", s.tries, "1 to 64");
    require(s.refineAt > 0 && std::isfinite(s.refineAt), "refineAt", s.refineAt, "above 0 and finite");
    require(s.coarsenAt > s.refineAt, "coarsenAt", s.coarsenAt, "above refineAt");
    require(s.mostMoves >= 1, "mostMoves", s.mostMoves, "1 or more");
    require(s.removeFactor >= 1 && std::isfinite(s.removeFactor), "removeFactor", s.removeFactor, "1 or more");
    require(s.removeOffset >= 0 && std::isfinite(s.removeOffset), "removeOffset", s.removeOffset, "0 or more");
    require(s.maxDistance >= 0 && std::isfinite(s.maxDistance), "maxDistance", s.maxDistance, "0 or more");
    require(s.mostSpread >= 0, "mostSpread", s.mostSpread, "0 or more");
    require(s.mostPairs >= 1, "mostPairs", s.mostPairs, "1 or more");
}

}  // namespace grapeshot::scf::reference
