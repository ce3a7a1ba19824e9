#include <grapeshot/adb/reference/probability.hpp>

#include <algorithm>

namespace grapeshot::reference {

SharedCells sharedCells(const FilledNode& a, const FilledNode& b, double sharedVolume) {
    const double sideA = std::cbrt(a.extent->volume / a.cells);
    const double sideB = std::cbrt(b.extent->volume / b.cells);
    const double side = std::min(sideA, sideB);
    const double s = sharedVolume / (side * side * side);
    const auto filled = [&](const FilledNode& node, double ownSide) {
        return s * std::min(1.0, static_cast<double>(node.wellFilled) / node.cells * (side / ownSide));
    };
    return {s, filled(a, sideA), filled(b, sideB)};
}

}  // namespace grapeshot::reference
