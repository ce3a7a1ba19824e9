// The regions of a step: cuts that are near each other, and the summits that are climbed to from them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <grapeshot/core/detail/point_grid.hpp>
#include <grapeshot/core/topology.hpp>
#include <grapeshot/scf/depth.hpp>
#include <grapeshot/scf/detail/depth_climb.hpp>
#include <grapeshot/scf/detail/key_map.hpp>
#include <grapeshot/scf/detail/meter.hpp>

namespace grapeshot::detail {

/// What is known of a mesh at rest.
struct DepthBody {
    explicit DepthBody(const BallTree& tree);

    Topology topology;
    bool isSolid = false;                ///< closed
    int outwards = 1;                    ///< -1 if the triangles are inside out
    std::vector<std::uint32_t> pieceOf;  ///< per welded vertex
    std::vector<std::uint32_t> pieceAt;  ///< per piece: a vertex of it
};

/// Memory that is worth keeping.
struct DepthScratch {
    DepthClimb climb;
    PointGrid grid;
    std::vector<Eigen::Vector3f> points;
    std::vector<std::uint32_t> cuts;  ///< contacts
    std::vector<std::uint32_t> open, group;
    std::vector<char> isTaken;
    std::vector<ClimbStart> starts;
    std::vector<char> isCutA, isCutB;  ///< per piece
    KeyMap cutAt, cutAtA;              ///< by vertices of both, and of A: a cut
    std::vector<std::uint32_t> root;   ///< per point: its component
};

class DepthStep {
  public:
    DepthStep(const DepthBody& bodyA, PosedTree& a, const DepthBody& bodyB, PosedTree& b, const DepthSettings& settings,
              DepthScratch& scratch)
        : m_bodyA(bodyA),
          m_bodyB(bodyB),
          m_a(a, bodyA.topology),
          m_b(b, bodyB.topology),
          m_settings(settings),
          m_scratch(scratch) {}

    void run(std::span<const TrackedContact> contacts, std::span<const ContactSides> sides, const DepthMemory& memory,
             Meter& meter, DepthMemory& next, DepthResult& out);

  private:
    /// Points of the cuts, and behind them the anchors of the summits before. False: one is not finite.
    [[nodiscard]] bool place();
    /// Without a spacing: components of cuts that share vertices, and the summits that are known again.
    void joinAlongCuts();
    [[nodiscard]] std::uint32_t rootOf(std::uint32_t point);
    void join(std::uint32_t first, std::uint32_t second);
    /// Which pieces of a body are cut?
    void markCutPieces(bool ofA);
    /// Takes all that hang together with a point into the group, ascending.
    void collect(std::uint32_t seed);
    void measureGroup();
    void measureContained(bool ofA);
    [[nodiscard]] std::optional<Summit> climbFrom(bool ofA);
    using Anchors = std::array<std::uint32_t, 4>;
    void report(bool ofA, const Summit& summit, std::uint32_t cuts, std::uint32_t age);
    void remember(bool ofA, const Summit& summit, const Anchors& anchors, std::uint32_t age);
    void reportCrossing(std::uint32_t cuts);
    [[nodiscard]] bool isSheet() const { return !m_sides.empty(); }
    [[nodiscard]] int sideOf(bool ofB, std::uint32_t contact) const;
    [[nodiscard]] Eigen::Vector3f middleOf(std::uint32_t triangleOfA) const;

    const DepthBody& m_bodyA;
    const DepthBody& m_bodyB;
    SurfaceProbe m_a, m_b;
    const DepthSettings& m_settings;
    DepthScratch& m_scratch;
    std::span<const TrackedContact> m_contacts;
    std::span<const ContactSides> m_sides;
    const DepthMemory* m_before = nullptr;
    DepthMemory* m_next = nullptr;
    Meter* m_meter = nullptr;
    DepthResult* m_out = nullptr;
};

}  // namespace grapeshot::detail
