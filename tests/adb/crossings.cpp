#include "crossings.hpp"

#include <cmath>
#include <cstring>

#include <support/test_size.hpp>

#include "meshes.hpp"

namespace grapeshot::test {

const std::vector<PairCase>& crossingCases() {
    static const std::vector<PairCase> all =
        pairCases({scenes::bumpySphere(1, 0.25F, 6, 10), scenes::torusKnot(3, 4, 1, 0.5F, 0.17F, 120, 10),
                   scenes::gear(1, 0.2F, 0.3F, 0.3F, 12, 2)},
                  6, static_cast<int>(sampleSize(8, 100)), 17);
    return all;
}

bool samePieces(const Crossing& a, const Crossing& b) {
    static_assert(sizeof(CurvePiece) == 12 * sizeof(float), "has no padding");
    return a.pieces.size() == b.pieces.size() &&
           (a.pieces.empty() ||
            std::memcmp(static_cast<const void*>(a.pieces.data()), static_cast<const void*>(b.pieces.data()),
                        a.pieces.size() * sizeof(CurvePiece)) == 0);
}

bool same(const Crossing& a, const Crossing& b) {
    return samePieces(a, b) && a.rate == b.rate && a.certain == b.certain && a.stop == b.stop && a.work == b.work;
}

testing::AssertionResult wellFormed(const Crossing& crossing) {
    if (!std::isfinite(crossing.rate) || crossing.rate < 0) {
        return testing::AssertionFailure() << "rate " << crossing.rate;
    }
    if (crossing.certain != (crossing.stop == StopReason::certain)) {
        return testing::AssertionFailure() << "certain, but stopped otherwise";
    }
    bool stillProven = true;
    for (std::size_t i = 0; i < crossing.pieces.size(); ++i) {
        const CurvePiece& piece = crossing.pieces[i];
        const auto failure = [&](const char* what) {
            return testing::AssertionFailure()
                   << what << " of piece " << i << " of " << crossing.pieces.size() << ": at "
                   << piece.position.transpose() << ", direction " << piece.direction.transpose() << ", length "
                   << piece.length << ", extent " << piece.extent << ", slope " << piece.slope << ", rate "
                   << piece.rate;
        };
        if (!piece.position.allFinite()) {
            return failure("position");
        }
        if (!(piece.direction.norm() <= 2.001F)) {
            return failure("direction");
        }
        if (!(std::isfinite(piece.length) && piece.length >= 0)) {
            return failure("length");
        }
        if (!(std::isfinite(piece.extent) && piece.extent >= 0)) {
            return failure("extent");
        }
        if (!(std::isfinite(piece.slope) && piece.slope >= 0)) {
            return failure("slope");
        }
        if (piece.proven() ? !std::isinf(piece.rate) : !(std::isfinite(piece.rate) && piece.rate >= 0)) {
            return failure("rate");
        }
        if (piece.proven() != (piece.pair.triangleB != noTriangle) || (piece.proven() && !stillProven) ||
            (crossing.certain && !piece.proven())) {
            return failure("proof");
        }
        stillProven = piece.proven();
    }
    return testing::AssertionSuccess();
}

std::vector<TrianglePair> provenPairs(const Crossing& crossing) {
    std::vector<TrianglePair> pairs;
    for (const CurvePiece& piece : crossing.pieces) {
        if (piece.proven()) {
            pairs.push_back(piece.pair);
        }
    }
    return pairs;
}

double totalLength(const Crossing& crossing) {
    double sum = 0;
    for (const CurvePiece& piece : crossing.pieces) {
        sum += piece.length;
    }
    return sum;
}

Crossing exactCrossing(const Tree& a, const Tree& b, const Pose& pose) {
    return crossingAfter(a, b, pose, unlimited);
}

Crossing crossingAfter(const Tree& a, const Tree& b, const Pose& pose, std::uint64_t work, float leaveOut) {
    Crossing crossing;
    CrossingQuery(a, b).find(pose, {.leaveOut = leaveOut}, {work}, crossing);
    return crossing;
}

}  // namespace grapeshot::test
