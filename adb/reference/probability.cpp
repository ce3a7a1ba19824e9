#include <grapeshot/adb/reference/probability.hpp>

#include <algorithm>

namespace grapeshot::reference {

SharedCells sharedCells(const FilledNode& a, const FilledNode& b, double sharedVolume) {
    const double sideA = a.extent->meanSide / a.grid;
    const double sideB = b.extent->meanSide / b.grid;
    const double side = std::min(sideA, sideB);
    const double s = sharedVolume / (side * side * side);
    const auto filled = [&](const FilledNode& node, double ownSide) {
        return s * std::min(1.0, node.wellFilled / static_cast<double>(node.grid * node.grid * node.grid) *
                                     (side / ownSide));
    };
    return {s, filled(a, sideA), filled(b, sideB)};
}

}  // namespace grapeshot::reference
