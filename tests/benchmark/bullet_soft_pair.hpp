// Two of Bullet's soft bodies without a solver: their trees brought up to date, and collided node against face.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>

#include <scenes/shapes.hpp>

namespace grapeshot::bench {

class BulletSoftPair {
  public:
    enum class Trees {
        byBullet,  ///< btSoftBody::initializeFaceTree, which compares all pairs of faces: quadratic
        quickly,   ///< the same trees by way of a list of neighbours
    };
    /// Both meshes closed. Nodes nearer to a face than `distance`, m, are contacts.
    BulletSoftPair(const scenes::Mesh& a, const scenes::Mesh& b, float distance, Trees trees);
    ~BulletSoftPair();
    BulletSoftPair(const BulletSoftPair&) = delete;
    BulletSoftPair& operator=(const BulletSoftPair&) = delete;

    /// What a solver would have done: nodes stand there, and are at rest.
    void place(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b);
    /// updateNodeTree and updateFaceTree of both.
    void updateTrees();
    /// Bullet's handler for VF_SS: nodes of each against faces of the other. Returns how many contacts there are.
    std::size_t collide();

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot::bench
