#include <grapeshot/narrowphase/penetration.hpp>

#include <algorithm>

#include <grapeshot/narrowphase/detail/cut_depth.hpp>
#include <grapeshot/narrowphase/detail/surface_cut.hpp>

namespace grapeshot {
namespace {

// Columns shallower than this part of the deepest carry nothing.
constexpr float leastDepth = 0.3F;
// Contacts of a cut are at least this part of the spacing apart.
constexpr float leastSpread = 0.25F;

/// Does some penetrating contact near the curve push much the same way?
bool isExplained(const detail::SurfaceCut& cut, std::span<const detail::CutPiece> pieces,
                 std::span<const SurfaceContact> already, float within) {
    const Eigen::Vector3f normal = cut.normal.cast<float>();
    for (const SurfaceContact& contact : already) {
        if (!(contact.signedDistance < 0) || contact.normal.dot(normal) < 0.5F) {
            continue;
        }
        const Eigen::Vector3f middle = 0.5F * (contact.onA + contact.onB);
        if (std::any_of(pieces.begin(), pieces.end(), [&](const detail::CutPiece& piece) {
                return (piece.middle - middle).squaredNorm() <= within * within;
            })) {
            return true;
        }
    }
    return false;
}

/// Two triangles that cross each other have to be parted by that much at least.
SurfaceContact deepestOverlap(const detail::SurfaceCut& cut, std::span<const detail::CutPiece> pieces) {
    const auto deepest = std::max_element(
        pieces.begin(), pieces.end(), [](const auto& left, const auto& right) { return left.overlap < right.overlap; });
    SurfaceContact contact;
    contact.normal = cut.normal.cast<float>().normalized();
    contact.onA = deepest->middle - contact.normal * (0.5F * deepest->overlap);
    contact.onB = deepest->middle + contact.normal * (0.5F * deepest->overlap);
    contact.signedDistance = -deepest->overlap;
    contact.triangleA = deepest->pair.triangleA;
    contact.triangleB = deepest->pair.triangleB;
    return contact;
}

/// The deepest column, then those farthest from the ones chosen.
void choose(std::vector<SurfaceContact>& columns, const PenetrationSettings& settings,
            std::vector<SurfaceContact>& out) {
    std::stable_sort(columns.begin(), columns.end(), [](const SurfaceContact& left, const SurfaceContact& right) {
        return left.signedDistance < right.signedDistance;
    });
    const float limit = leastDepth * columns.front().signedDistance;
    const std::size_t first = out.size();
    const auto most = static_cast<std::size_t>(std::clamp(settings.maxContacts, 1, 4));
    const auto middle = [](const SurfaceContact& contact) -> Eigen::Vector3f {
        return 0.5F * (contact.onA + contact.onB);
    };
    out.push_back(columns.front());
    while (out.size() - first < most) {
        float farthest = leastSpread * settings.spacing;
        farthest *= farthest;
        const SurfaceContact* best = nullptr;
        for (const SurfaceContact& column : columns) {
            if (column.signedDistance > limit) {
                break;
            }
            float nearest = (middle(out[first]) - middle(column)).squaredNorm();
            for (std::size_t i = first + 1; i < out.size(); ++i) {
                nearest = std::min(nearest, (middle(out[i]) - middle(column)).squaredNorm());
            }
            if (nearest > farthest) {
                farthest = nearest;
                best = &column;
            }
        }
        if (best == nullptr) {
            return;
        }
        out.push_back(*best);
    }
}

}  // namespace

void penetrationContacts(const MeshModel& a, const MeshModel& b, const Pose& bInA,
                         std::span<const TriangleContact> pairs, std::span<const SurfaceContact> already,
                         const PenetrationSettings& settings, std::vector<SurfaceContact>& out) {
    thread_local detail::SurfaceCuts cuts;
    thread_local std::vector<SurfaceContact> columns;
    detail::findCuts(a, b, bInA, pairs, settings.spacing, cuts);
    for (const detail::SurfaceCut& cut : cuts.cuts) {
        const auto pieces = cuts.piecesOf(cut);
        if (isExplained(cut, pieces, already, settings.explainedWithin)) {
            continue;
        }
        columns.clear();
        detail::measureColumns(a, b, bInA, cut, pieces, 0.5F * settings.spacing, columns);
        const SurfaceContact overlap = deepestOverlap(cut, pieces);
        const bool deeper = std::all_of(columns.begin(), columns.end(), [&](const SurfaceContact& column) {
            return overlap.signedDistance < column.signedDistance;
        });
        if (deeper && overlap.signedDistance < 0) {
            columns.push_back(overlap);
        }
        if (!columns.empty()) {
            choose(columns, settings, out);
        }
    }
}

}  // namespace grapeshot
