#include <grapeshot/adb/reference/leaf_test.hpp>
#include <grapeshot/adb/reference/triangle_overlap.hpp>

namespace grapeshot::reference {

bool leavesOverlap(const Hierarchy& a, const TreeNode& leafA, const Hierarchy& b, const TreeNode& leafB,
                   const Placement& placement, std::size_t& tests) {
    for (std::uint32_t tB = leafB.begin; tB < leafB.end; ++tB) {
        std::array<Eigen::Vector3d, 3> moved;
        for (std::size_t c = 0; c < 3; ++c) {
            moved[c] = placement.toA(b.triangles[tB][c]);
        }
        for (std::uint32_t tA = leafA.begin; tA < leafA.end; ++tA) {
            ++tests;
            if (trianglesOverlap(a.triangles[tA], moved)) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace grapeshot::reference
