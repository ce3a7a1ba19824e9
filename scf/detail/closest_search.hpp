// Branch and bound over two ball trees: the pairs of triangles by their distance, nearest first.
#pragma once

#include <cstdint>
#include <vector>

#include <grapeshot/scf/closest_features.hpp>
#include <grapeshot/scf/detail/descent.hpp>
#include <grapeshot/scf/detail/meter.hpp>
#include <grapeshot/scf/detail/pair_batch.hpp>
#include <grapeshot/scf/detail/pair_space.hpp>

namespace grapeshot::detail {

class ClosestSearch {
  public:
    /// Both must stay until the run ends.
    void begin(const PairSpace& space, const ClosestSettings& settings);
    /// Tests a pair and what is around it downhill. Of a body with itself the pair alone.
    void look(const TrianglePair& pair);
    /// False: the budget ended before; then the nearest of those that were tested follow.
    bool run(Meter& meter, std::vector<FeaturePair>& out);

    [[nodiscard]] float atLeast() const { return m_atLeast; }
    [[nodiscard]] bool isFinite() const { return m_batch.isFinite(); }
    [[nodiscard]] std::uint64_t work() const { return m_work; }

  private:
    /// Two pieces, which are no nearer.
    struct Waiting {
        float distance = 0;
        BallPair pair;
    };
    void open(const Waiting& pieces);
    void openLeaves(std::uint32_t leafA, std::uint32_t leafB);
    void testFans(std::uint32_t vertexA, std::uint32_t vertexB);
    void flush();
    void boundByCenters(const FourBalls& a, const FourBalls& b, const ChildPairs& children, const float (&between)[16]);
    bool emit(std::vector<FeaturePair>& out);
    [[nodiscard]] std::uint32_t centerOf(const BallTree& tree, BallRef ref) const { return tree.own(ref).center; }

    const PairSpace* m_space = nullptr;
    const ClosestSettings* m_settings = nullptr;
    std::vector<Waiting> m_waiting;    ///< heap, nearest on top
    std::vector<FeaturePair> m_found;  ///< heap, nearest on top; not emitted yet
    PairBatch m_batch;
    float m_limit = 0;  ///< m: what is farther is of no interest
    /// Two vertices that the limit comes from, until a pair of triangles is known to be as near.
    VertexPair m_centers;
    bool m_isByCenters = false;
    float m_atLeast = 0;
    std::uint64_t m_work = 0;
};

}  // namespace grapeshot::detail
