// What is right: two exact programs that agree, and a careful third look where they do not.
#pragma once

#include <string>
#include <vector>

#include "peer.hpp"

namespace grapeshot::bench {

struct Truth {
    std::vector<char> collides;
    std::size_t colliding = 0;
    std::size_t disagreements = 0;  ///< answered otherwise by FCL, and not because the pose is borderline
    std::size_t borderline = 0;     ///< answered otherwise by FCL; gap or depth below 1e-6 of the size: both are right
    std::size_t uncertain = 0;      ///< exact answers that do not call themselves certain
};

/// Our exact answers, checked against FCL's. Disagreements go to the error stream, and are settled by `clearance`.
[[nodiscard]] Truth checkedTruth(const std::string& name, const Tree& a, const Tree& b, const std::vector<Pose>& poses,
                                 const Peer& fcl);

/// Our exact answers alone: where FCL would take too long, or has been asked about such poses before.
[[nodiscard]] Truth exactTruth(const Tree& a, const Tree& b, const std::vector<Pose>& poses);

struct Errors {
    double falseNegatives = 0;
    double falsePositives = 0;
    [[nodiscard]] double percentOf(std::size_t n) const {
        return n > 0 ? 100 * (falseNegatives + falsePositives) / static_cast<double>(n) : 0;
    }
    void add(bool answer, bool truth) {
        falseNegatives += truth && !answer ? 1 : 0;
        falsePositives += answer && !truth ? 1 : 0;
    }
};

}  // namespace grapeshot::bench
