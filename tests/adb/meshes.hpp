// Meshes that every test of this room runs on.
#pragma once

#include <string>
#include <vector>

#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/instruction_set.hpp>
#include <scenes/shapes.hpp>

namespace grapeshot::test {

struct NamedMesh {
    std::string name;
    scenes::Mesh mesh;
};

/// One of each kind that demos/scenes makes, of some hundred triangles, normalised to diagonal 2, and a soup of
/// unconnected triangles.
const std::vector<NamedMesh>& everyKind();

/// Triangles with corners anywhere in the unit cube, each of extent up to `extent`.
scenes::Mesh soup(int triangles, float extent, std::uint64_t seed);

/// Triangles of length 1 and width 1e-8, in a bundle.
scenes::Mesh needles(int count);

/// The same triangle again and again.
scenes::Mesh copiesOfOne(int count);

/// Length of the diagonal of the tree's box, m.
double sizeOf(const Tree& tree);

/// The best instruction set again when the scope ends.
class InstructionSetGuard {
  public:
    InstructionSetGuard() : m_before(instructionSet()) {}
    ~InstructionSetGuard() { limitInstructionSet(m_before); }
    InstructionSetGuard(const InstructionSetGuard&) = delete;
    InstructionSetGuard& operator=(const InstructionSetGuard&) = delete;

  private:
    InstructionSet m_before;
};

/// Those of the three that this machine and build have; at least scalar.
std::vector<InstructionSet> instructionSets();

}  // namespace grapeshot::test
