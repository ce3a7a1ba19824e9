#include "truth.hpp"

#include <cmath>
#include <iostream>

#include "clearance.hpp"
#include "stopped.hpp"

namespace grapeshot::bench {

Truth checkedTruth(const std::string& name, const Tree& a, const Tree& b, const std::vector<Pose>& poses,
                   const Peer& fcl) {
    /// In single precision, poses closer than this part of the size to touching may go either way.
    constexpr double borderline = 1e-6;
    const double size = 0.5 * static_cast<double>((a.upper - a.lower).norm() + (b.upper - b.lower).norm());
    Query query(a, b);
    Truth truth;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Decision ours = query.decide(poses[i], exactShuffled());
        bool collides = ours.collides;
        truth.uncertain += ours.certain ? 0U : 1U;
        if (fcl.decide(poses[i]).collides != ours.collides) {
            const double gap = clearance(a.mesh(), b.mesh(), poses[i], 100 * borderline * size);
            if (std::abs(gap) < borderline * size) {
                ++truth.borderline;
            } else {
                ++truth.disagreements;
                collides = gap <= 0;
                std::cerr << name << ": pose " << i << " is answered " << ours.collides << " and by FCL "
                          << !ours.collides << "; clearance " << gap / size << " of the size\n";
            }
        }
        truth.collides.push_back(collides ? 1 : 0);
        truth.colliding += collides ? 1U : 0U;
    }
    return truth;
}

Truth exactTruth(const Tree& a, const Tree& b, const std::vector<Pose>& poses) {
    Query query(a, b);
    Truth truth;
    for (const Pose& pose : poses) {
        const Decision decision = query.decide(pose, exactShuffled());
        truth.uncertain += decision.certain ? 0U : 1U;
        truth.colliding += decision.collides ? 1U : 0U;
        truth.collides.push_back(decision.collides ? 1 : 0);
    }
    return truth;
}

}  // namespace grapeshot::bench
