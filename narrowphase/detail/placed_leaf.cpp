#include <grapeshot/narrowphase/detail/placed_leaf.hpp>

#include <cmath>

#include <grapeshot/narrowphase/detail/extremum.hpp>

namespace grapeshot::detail {
namespace {

using Eigen::Vector3f;
using Four = Eigen::Array<float, 4, 1>;

struct Four3 {
    Four x, y, z;
};
Four3 operator-(const Four3& a, const Four3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Four3 cross(const Four3& a, const Four3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Four3 turned(const Four3& v, const Eigen::Matrix3f& r) {
    return {r(0, 0) * v.x + r(0, 1) * v.y + r(0, 2) * v.z, r(1, 0) * v.x + r(1, 1) * v.y + r(1, 2) * v.z,
            r(2, 0) * v.x + r(2, 1) * v.y + r(2, 2) * v.z};
}

Four fourOf(const float (&lanes)[4]) {
    return Four(lanes[0], lanes[1], lanes[2], lanes[3]);
}
Four3 load(const float (&rows)[3][4]) {
    return {fourOf(rows[0]), fourOf(rows[1]), fourOf(rows[2])};
}
void store(const Four& v, float (&lanes)[4]) {
    Eigen::Map<Four> out(lanes);
    out = v;
}
void store(const Four3& v, float (&rows)[3][4]) {
    store(v.x, rows[0]);
    store(v.y, rows[1]);
    store(v.z, rows[2]);
}
/// Straight into registers: what was stored float by float cannot be loaded by fours at once.
Four3 gather(const Vector3f* const (&from)[4]) {
    return {Four(from[0]->x(), from[1]->x(), from[2]->x(), from[3]->x()),
            Four(from[0]->y(), from[1]->y(), from[2]->y(), from[3]->y()),
            Four(from[0]->z(), from[1]->z(), from[2]->z(), from[3]->z())};
}

}  // namespace

void LeafPlacer::start(const MeshSide& side, float lean) {
    m_side = side;
    const float widening = coneWidening(lean);
    m_cosLean = std::cos(widening);
    m_sinLean = std::sin(widening);
    m_used = 0;
    if (++m_epoch == 0) {
        m_places.clear();
        m_epoch = 1;
    }
    if (m_places.size() < side.model().tree.leaves.size()) {
        m_places.resize(side.model().tree.leaves.size());
    }
}

LeafPlacer::Entry& LeafPlacer::makeEntry(Place& place) {
    if (m_used == m_chunks.size() * chunk) {
        m_chunks.emplace_back(chunk);
    }
    place = {m_epoch, m_used++};
    Entry& made = at(place.index);
    made.hasRows = made.hasTriangles = false;
    return made;
}

void LeafPlacer::fillTriangles(std::uint32_t leaf, std::array<PlacedTriangle, 4>& triangles) const {
    const LeafBlock& block = m_side.model().tree.leaves[leaf];
    for (unsigned lane = 0; lane < 4; ++lane) {
        if (block.triangle[lane] != noTriangle) {
            m_side.place(block.triangle[lane], triangles[lane]);
        }
    }
}

void LeafPlacer::fillRows(std::uint32_t leaf, LeafRows& rows) const {
    const MeshModel& model = m_side.model();
    const LeafBlock& block = model.tree.leaves[leaf];
    const unsigned bends = bentEdges(model);
    rows.valid = 0;
    for (unsigned i = 0; i < 3; ++i) {
        rows.sharpCorner[i] = rows.bent[i] = rows.sharp[i] = rows.gap[i] = rows.ownCorner[i] = rows.ownEdge[i] = 0;
    }
    static const Vector3f none = Vector3f::Zero();
    const Vector3f* normals[4];
    const Vector3f* across[3][4];
    const Vector3f* upward[3][4];
    for (unsigned lane = 0; lane < 4; ++lane) {
        const bool used = block.triangle[lane] != noTriangle;
        const std::uint32_t triangle = used ? block.triangle[lane] : block.triangle[0];
        const std::uint32_t bit = used ? 1U << lane : 0U;
        const Triangle& corners = model.tree.triangles[triangle];
        rows.valid |= bit;
        normals[lane] = &model.triangleNormals[triangle];
        for (unsigned i = 0; i < 3; ++i) {
            const std::uint32_t other = model.topology.across[triangle][i];
            const std::uint32_t vertex = model.topology.welded[corners[i]];
            across[i][lane] = other == noNeighbour ? &none : &model.triangleNormals[other];
            upward[i][lane] = &model.vertexNormals[vertex];
            rows.coneCosine[i][lane] = widenedCone(model.vertexCones[vertex], m_cosLean, m_sinLean);
            const unsigned traits = static_cast<unsigned>(model.traits[triangle]) >> i;
            rows.sharpCorner[i] |= (traits & flatCorner) == 0 ? bit : 0U;
            rows.bent[i] |= (traits & bends) != 0 ? bit : 0U;
            rows.sharp[i] |= (traits & sharpEdge) != 0 ? bit : 0U;
            rows.ownCorner[i] |= model.vertexTriangle[vertex] == triangle ? bit : 0U;
            rows.ownEdge[i] |= triangle <= other ? bit : 0U;
            rows.gap[i] |= (model.solid ? (traits & concaveEdge) != 0 : other != noNeighbour) ? bit : 0U;
        }
    }
    const Pose* pose = m_side.pose();
    const auto placed = [&](const Four3& direction) {
        return pose == nullptr ? direction : turned(direction, pose->rotation);
    };
    const Four3 normal = placed(gather(normals));
    store(normal, rows.normal);
    Four3 corner[3];
    for (unsigned i = 0; i < 3; ++i) {
        corner[i] = placed(load(block.corner[i]));
        if (pose != nullptr) {
            corner[i].x += pose->translation.x();
            corner[i].y += pose->translation.y();
            corner[i].z += pose->translation.z();
        }
        store(corner[i], rows.corner[i]);
        store(placed(gather(across[i])), rows.across[i]);
        store(placed(gather(upward[i])), rows.upward[i]);
    }
    for (unsigned i = 0; i < 3; ++i) {
        Four3 along = corner[(i + 1) % 3] - corner[i];
        const Four length = (along.x * along.x + along.y * along.y + along.z * along.z).sqrt();
        const Four over = (length > 0).select(1 / length, 0);
        along = {along.x * over, along.y * over, along.z * over};
        store(length, rows.length[i]);
        store(along, rows.along[i]);
        store(cross(along, normal), rows.outward[i]);
    }
}

}  // namespace grapeshot::detail
