// The trees of the meshes that a suite reports.
#pragma once

#include <string>
#include <vector>

#include <grapeshot/adb/tree.hpp>

#include "meshes.hpp"

namespace grapeshot::bench {

/// A reported mesh and its tree, which is somebody else's.
struct TreeOf {
    std::string name;
    const Tree* tree;
};

/// Owns a tree per mesh. Must outlive what looks at them.
class NamedTrees {
  public:
    explicit NamedTrees(const std::vector<NamedMesh>& meshes) {
        m_trees.reserve(meshes.size());
        for (const NamedMesh& mesh : meshes) {
            m_trees.push_back(build(mesh.mesh.view()));
            m_all.push_back({mesh.name, &m_trees.back()});
        }
    }
    NamedTrees(const NamedTrees&) = delete;
    NamedTrees& operator=(const NamedTrees&) = delete;
    [[nodiscard]] const std::vector<TreeOf>& all() const { return m_all; }

  private:
    std::vector<Tree> m_trees;
    std::vector<TreeOf> m_all;
};

}  // namespace grapeshot::bench
