#include <grapeshot/narrowphase/detail/box_cut.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/narrowphase/contact_set.hpp>
#include <grapeshot/narrowphase/penetration.hpp>

namespace grapeshot::detail {
namespace {

using Eigen::Vector3f;

MeshModel boxModel(const Vector3f& half) {
    std::vector<Vector3f> vertices;
    for (unsigned c = 0; c < 8; ++c) {
        vertices.emplace_back((c & 1U) != 0 ? half.x() : -half.x(), (c & 2U) != 0 ? half.y() : -half.y(),
                              (c & 4U) != 0 ? half.z() : -half.z());
    }
    static constexpr std::array<Triangle, 12> triangles{{{0, 4, 6},
                                                         {0, 6, 2},
                                                         {1, 3, 7},
                                                         {1, 7, 5},
                                                         {0, 1, 5},
                                                         {0, 5, 4},
                                                         {2, 6, 7},
                                                         {2, 7, 3},
                                                         {0, 2, 3},
                                                         {0, 3, 1},
                                                         {4, 5, 7},
                                                         {4, 7, 6}}};
    return makeModel({vertices, triangles});
}

}  // namespace

const MeshModel& modelOfBox(const Vector3f& half) {
    struct Entry {
        Vector3f half = Vector3f::Zero();
        std::optional<MeshModel> model;
    };
    thread_local std::array<Entry, 16> entries;
    thread_local std::size_t oldest = 0;
    const auto known = std::find_if(entries.begin(), entries.end(),
                                    [&](const Entry& entry) { return entry.model && entry.half == half; });
    if (known != entries.end()) {
        return *known->model;
    }
    MeshModel made = boxModel(half);
    Entry& entry = entries[oldest];
    oldest = (oldest + 1) % entries.size();
    entry = {half, std::move(made)};
    return *entry.model;
}

bool canReachThrough(const MeshModel& mesh, const BoxSolid& box) {
    const Vector3f middle = (mesh.tree.lower + mesh.tree.upper) / 2;
    const Vector3f half = (mesh.tree.upper - mesh.tree.lower) / 2;
    const Vector3f inBox = box.pose.rotation.transpose() * (middle - box.pose.translation);
    const Vector3f reach = box.pose.rotation.transpose().cwiseAbs() * half;
    const Vector3f least = inBox - reach;
    const Vector3f most = inBox + reach;
    const bool meets = (least.array() <= box.half.array()).all() && (most.array() >= -box.half.array()).all();
    return meets && ((least.array() < -box.half.array()) && (most.array() > box.half.array())).any();
}

std::uint64_t boxCutContacts(const MeshModel& mesh, const BoxSolid& box, std::vector<SurfaceContact>& out,
                             LeafChoice* choice) {
    if (!(box.half.minCoeff() > 0) || !canReachThrough(mesh, box)) {
        return 0;
    }
    const MeshModel& model = modelOfBox(box.half);
    thread_local Contacts contacts;
    const Budget budget = choice != nullptr ? choice->purse.left() : Budget();
    Query(mesh.tree, model.tree).contacts(box.pose, {0, Order::depthFirst}, budget, contacts);
    if (choice != nullptr) {
        choice->purse.pay(contacts.work);
        choice->complete = choice->complete && contacts.certain;
        if (!choice->complete) {
            return contacts.work;  // half a cut tells the wrong direction
        }
    }
    const std::size_t first = out.size();
    const float spacing = 0.25F * std::min(mesh.tree.radius, box.half.norm());
    penetrationContacts(mesh, model, box.pose, contacts.pairs, {}, {spacing, spacing, maxPointsPerRegion}, out);
    for (std::size_t i = first; i < out.size(); ++i) {
        out[i].triangleB = noTriangle;
    }
    return contacts.work;
}

}  // namespace grapeshot::detail
