#include <grapeshot/scf/detail/surface_input.hpp>

#include <algorithm>
#include <cmath>

namespace grapeshot::detail {

bool isOfSurface(const Surface& surface, std::initializer_list<std::span<const Eigen::Vector3f>> positions,
                 std::span<const Triangle> triangles) {
    for (const std::span<const Eigen::Vector3f> some : positions) {
        if (!some.empty() && some.size() != surface.rest.size()) {
            return false;
        }
    }
    return triangles.empty() ||
           (triangles.size() == surface.triangles.size() && topologyKey(triangles) == surface.topology);
}

bool isUsable(const Stretch& stretch) {
    return stretch.source >= Stretch::Source::given && stretch.source <= Stretch::Source::refitted &&
           (stretch.source == Stretch::Source::refitted || (std::isfinite(stretch.bound) && stretch.bound > 0));
}

bool isUsable(const Displacement& displacement) {
    return displacement.source >= Displacement::Source::unknown &&
           displacement.source <= Displacement::Source::measured && std::isfinite(displacement.bound) &&
           displacement.bound >= 0;
}

float stretchToUse(const Stretch& stretch, const Surface& surface,
                   std::initializer_list<std::span<const Eigen::Vector3f>> positions) {
    if (stretch.source != Stretch::Source::measured) {
        return stretch.source == Stretch::Source::given ? stretch.bound : 0;
    }
    float largest = 0;
    for (auto some = positions.begin(); some != positions.end(); ++some) {
        if (some != positions.begin() && some->data() == positions.begin()->data()) {
            continue;  // nothing has moved
        }
        const float measured = some->empty() ? 1 : measureStretch(surface, *some);
        if (std::isnan(measured)) {
            return measured;
        }
        largest = std::max(largest, measured);
    }
    if (!(largest <= stretch.bound)) {
        return 0;
    }
    return largest > 0 ? largest : 1;  // all edges shrunk to nothing
}

}  // namespace grapeshot::detail
