#include "spline_surface.hpp"

#include <algorithm>
#include <cmath>

namespace grapeshot::soft {

SplineRow splineRow(double place, int count, bool closed) {
    const double middle = std::floor(place + 0.5);
    const double t = place - middle;  // -0.5..0.5
    SplineRow row;
    row.weight = {0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)};
    for (int i = 0; i < 3; ++i) {
        const int at = static_cast<int>(middle) + i - 1;
        row.index[static_cast<std::size_t>(i)] = closed ? (at + count) % count : std::clamp(at, 0, count - 1);
    }
    return row;
}

}  // namespace grapeshot::soft
