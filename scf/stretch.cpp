#include <grapeshot/scf/stretch.hpp>

#include <cassert>
#include <cmath>
#include <limits>

namespace grapeshot {

float measureStretch(const Surface& surface, std::span<const Eigen::Vector3f> positions) noexcept {
    assert(positions.size() == surface.rest.size());
    // Cross-multiplied: a division per edge would be most of the time.
    float most = 0;
    float finite = 0;  // stays 0, or becomes NaN
    const std::uint32_t* const others = surface.edges.all.data();
    const float* const squares = surface.edgeSquare.data();
    const auto count = static_cast<std::uint32_t>(positions.size());
    for (std::uint32_t v = 0; v < count; ++v) {
        const Eigen::Vector3f from = positions[v];
        finite += (from[0] - from[0]) + (from[1] - from[1]) + (from[2] - from[2]);
        for (std::uint32_t i = surface.edges.begin[v]; i < surface.edges.begin[v + 1]; ++i) {
            const Eigen::Vector3f& to = positions[others[i]];
            const float x = to[0] - from[0];
            const float y = to[1] - from[1];
            const float z = to[2] - from[2];
            const float square = x * x + y * y + z * z;
            if (square > most * squares[i]) [[unlikely]] {
                most = squares[i] > 0 ? square / squares[i] : std::numeric_limits<float>::infinity();
            }
        }
    }
    return finite == 0 ? std::sqrt(most) : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace grapeshot
