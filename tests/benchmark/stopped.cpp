#include "stopped.hpp"

#include <algorithm>
#include <cmath>
#include <support/poses.hpp>

namespace grapeshot::bench {

namespace {

Eigen::Vector3f middleOf(const Tree& tree) {
    return 0.5F * (tree.lower + tree.upper);
}

double boundingRadius(const Tree& tree) {
    float squared = 0;
    for (const Eigen::Vector3f& vertex : tree.vertices) {
        squared = std::max(squared, (vertex - middleOf(tree)).squaredNorm());
    }
    return std::sqrt(static_cast<double>(squared));
}

}  // namespace

RelativeDistance::RelativeDistance(const Tree& a, const Tree& b)
    : m_middleA(middleOf(a)), m_middleB(middleOf(b)), m_diameter(boundingRadius(a) + boundingRadius(b)) {}

std::size_t StoppedPrior::placeOf(double relativeDistance) {
    // The distances of zachmannPoses.
    const double share = (relativeDistance - 0.2) / (1.05 - 0.2);
    return static_cast<std::size_t>(std::clamp(std::lround(share * (places - 1)), 0L, static_cast<long>(places - 1)));
}

StoppedPrior::StoppedPrior(const std::vector<NamedMesh>& meshes, int perMesh, std::uint64_t seed) {
    std::array<std::array<double, places>, stepBudgets.size()> undecided{};
    for (const NamedMesh& named : meshes) {
        const Tree tree = build(named.mesh.view());
        const RelativeDistance distance(tree, tree);
        Query query(tree, tree);
        const int perDistance = (perMesh + static_cast<int>(places) - 1) / static_cast<int>(places);
        for (const Pose& pose : test::zachmannPoses(tree, tree, places, perDistance, seed).poses) {
            const Decision decision = query.decide(pose, exactShuffled());
            const std::size_t place = placeOf(distance(pose));
            for (std::size_t i = 0; i < stepBudgets.size() && decision.work > stepBudgets[i]; ++i) {
                undecided[i][place] += 1;
                m_share[i][place] += decision.collides ? 1 : 0;
            }
        }
    }
    for (std::size_t i = 0; i < stepBudgets.size(); ++i) {
        for (std::size_t place = 0; place < places; ++place) {
            // As if one more of each kind had been seen: of few or none nothing certain follows.
            m_share[i][place] = (m_share[i][place] + 1) / (undecided[i][place] + 2);
        }
    }
}

double StoppedPrior::probability(std::size_t budget, double relativeDistance) const {
    return m_share[budget][placeOf(relativeDistance)];
}

Peer stoppedPeer(const Tree& a, const Tree& b, std::size_t budget) {
    return makePeer("exact, " + std::to_string(stepBudgets[budget]) + " steps, else no",
                    [query = Query(a, b), budget](const Pose& pose) mutable {
                        const Decision decision = query.decide(pose, exactShuffled(), {.work = stepBudgets[budget]});
                        return Answer{decision.certain && decision.collides, decision.certain, decision.work};
                    });
}

Peer stoppedPeer(const Tree& a, const Tree& b, std::size_t budget, const StoppedPrior& prior) {
    return makePeer("exact, " + std::to_string(stepBudgets[budget]) + " steps, else prior",
                    [query = Query(a, b), budget, distance = RelativeDistance(a, b), &prior](const Pose& pose) mutable {
                        const Decision decision = query.decide(pose, exactShuffled(), {.work = stepBudgets[budget]});
                        const bool yes =
                            decision.certain ? decision.collides : prior.probability(budget, distance(pose)) >= 0.5;
                        return Answer{yes, decision.certain, decision.work};
                    });
}

}  // namespace grapeshot::bench
