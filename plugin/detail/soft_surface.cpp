#include <grapeshot/plugin/detail/soft_surface.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <grapeshot/core/error.hpp>
#include <grapeshot/plugin/detail/convert.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

int indexOf(const btSoftBody& body, const btSoftBody::Node* node) {
    return static_cast<int>(node - &body.m_nodes[0]);
}

/// Of a body whose elements did not change in number, so many are compared with what was read in each look: reading all
/// of a fine body's takes longer than its search.
constexpr std::size_t comparedAtOnce = 4096;

/// Nodes of each of the elements that make the surface; 0: there are none.
std::size_t cornersOf(const btSoftBody& body) {
    if (body.m_nodes.size() == 0) {
        return 0;
    }
    return body.m_tetras.size() > 0 ? 4 : (body.m_faces.size() > 0 ? 3 : 2);
}
std::size_t elementsOf(const btSoftBody& body) {
    const int sizes[] = {0, 0, body.m_links.size(), body.m_faces.size(), body.m_tetras.size()};
    return static_cast<std::size_t>(sizes[cornersOf(body)]);
}

/// Visits the node indices of so many elements, until it returns false.
template <class Visit>
bool visitElements(const btSoftBody& body, std::size_t first, std::size_t last, const Visit& visit) {
    const auto all = [&](const auto& elements, int corners) {
        for (std::size_t i = first; i < last; ++i) {
            for (int k = 0; k < corners; ++k) {
                if (!visit(indexOf(body, elements[static_cast<int>(i)].m_n[k]))) {
                    return false;
                }
            }
        }
        return true;
    };
    switch (cornersOf(body)) {
        case 4:
            return all(body.m_tetras, 4);
        case 3:
            return all(body.m_faces, 3);
        default:
            return all(body.m_links, 2);
    }
}

Triangle triangle(int a, int b, int c) {
    return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)};
}

/// Sides that only one tetrahedron has, seen from outside.
std::vector<Triangle> boundaryOf(const std::vector<int>& corners, const std::vector<Eigen::Vector3f>& rest) {
    struct Side {
        std::array<int, 3> sorted;
        Triangle outward;
    };
    std::vector<Side> sides;
    for (std::size_t i = 0; i + 3 < corners.size(); i += 4) {
        std::array<int, 4> c{corners[i], corners[i + 1], corners[i + 2], corners[i + 3]};
        const auto at = [&](int k) { return rest[static_cast<std::size_t>(c[static_cast<std::size_t>(k)])]; };
        if ((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) < 0) {
            std::swap(c[0], c[1]);
        }
        for (const auto& [p, q, r] :
             {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{1, 2, 3}, std::array{0, 3, 2}}) {
            const std::array<int, 3> side{c[static_cast<std::size_t>(p)], c[static_cast<std::size_t>(q)],
                                          c[static_cast<std::size_t>(r)]};
            sides.push_back({side, triangle(side[0], side[1], side[2])});
            std::ranges::sort(sides.back().sorted);
        }
    }
    std::ranges::stable_sort(sides, {}, &Side::sorted);
    std::vector<Triangle> boundary;
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i + 1;
        while (end < sides.size() && sides[end].sorted == sides[i].sorted) {
            ++end;
        }
        if (end == i + 1) {
            boundary.push_back(sides[i].outward);
        }
        i = end;
    }
    return boundary;
}

/// From the world into a frame.
class IntoFrame {
  public:
    explicit IntoFrame(const btTransform& frame)
        : m_inverse(frame.inverse()),
          m_origin(frame.getOrigin()),
          m_isTurned(!(frame.getBasis() == btMatrix3x3::getIdentity())) {}
    Eigen::Vector3f operator()(const btVector3& at) const {
        return toEigen(m_isTurned ? m_inverse * at : at - m_origin);
    }

  private:
    btTransform m_inverse;
    btVector3 m_origin;
    bool m_isTurned;
};

/// Also the middles of links. @param wrong sum of nothing times each position: no number if one is none
bool complete(const SoftSurface& surface, const Eigen::Vector3f& wrong, std::vector<Eigen::Vector3f>& positions) {
    if (!wrong.allFinite()) {
        return false;
    }
    if (surface.thread) {
        for (const Triangle& t : surface.triangles()) {
            positions[t[2]] = 0.5F * (positions[t[0]] + positions[t[1]]);
        }
    }
    return true;
}

template <class PositionOf>
bool readPositions(const btSoftBody& body, const SoftSurface& surface, const btTransform& frame,
                   std::vector<Eigen::Vector3f>& positions, const PositionOf& positionOf) {
    const IntoFrame intoFrame(frame);
    const auto nodes = static_cast<std::uint32_t>(body.m_nodes.size());
    positions.resize(surface.tree.surface.rest.size());
    if (nodes != surface.nodes) {
        return false;
    }
    Eigen::Vector3f wrong = Eigen::Vector3f::Zero();
    for (std::uint32_t i = 0; i < nodes; ++i) {
        positions[i] = intoFrame(positionOf(body.m_nodes[static_cast<int>(i)]));
        wrong += 0 * positions[i];
    }
    return complete(surface, wrong, positions);
}

}  // namespace

float longestWay(std::span<const Eigen::Vector3f> from, std::span<const Eigen::Vector3f> to) {
    float most = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        most = std::max(most, (to[i] - from[i]).squaredNorm());
    }
    return std::sqrt(most);
}

bool positionsOf(const btSoftBody& body, const SoftSurface& surface, NodePart part, const btTransform& frame,
                 std::vector<Eigen::Vector3f>& positions) {
    return readPositions(body, surface, frame, positions, [part](const btSoftBody::Node& node) {
        return part == NodePart::before ? node.m_q : node.m_x;
    });
}

bool positionsOf(const btSoftBody& body, const SoftSurface& surface, const btTransform& frameBefore,
                 const btTransform& frameAfter, std::vector<Eigen::Vector3f>& before,
                 std::vector<Eigen::Vector3f>& after) {
    const IntoFrame intoBefore(frameBefore);
    const IntoFrame intoAfter(frameAfter);
    const auto nodes = static_cast<std::uint32_t>(body.m_nodes.size());
    before.resize(surface.tree.surface.rest.size());
    after.resize(before.size());
    if (nodes != surface.nodes) {
        return false;
    }
    Eigen::Vector3f wrong = Eigen::Vector3f::Zero();
    for (std::uint32_t i = 0; i < nodes; ++i) {
        const btSoftBody::Node& node = body.m_nodes[static_cast<int>(i)];
        before[i] = intoBefore(node.m_q);
        after[i] = intoAfter(node.m_x);
        wrong += 0 * before[i] + 0 * after[i];
    }
    return complete(surface, wrong, before) && complete(surface, wrong, after);
}

bool deformedPositionsOf(const btSoftBody& body, const SoftSurface& surface, btScalar seconds, const btTransform& frame,
                         std::vector<Eigen::Vector3f>& positions) {
    return readPositions(body, surface, frame, positions,
                         [seconds](const btSoftBody::Node& node) { return node.m_x + seconds * node.m_v; });
}

bool SoftEntry::isChanged(const btSoftBody& body, bool thoroughly) {
    const std::array<int, 4> sizes{body.m_nodes.size(), body.m_tetras.size(), body.m_faces.size(), body.m_links.size()};
    const std::size_t elements = elementsOf(body);
    const std::size_t corners = cornersOf(body);
    const bool sameSizes = sizes[0] == m_sizes[0] && sizes[1] == m_sizes[1] && sizes[2] == m_sizes[2] &&
                           elements * corners == m_elements.size();
    if (sameSizes) {
        const std::size_t first = thoroughly || m_compared >= elements ? 0 : m_compared;
        const std::size_t last = thoroughly ? elements : std::min(elements, first + comparedAtOnce);
        std::size_t i = first * corners;
        m_compared = last;
        if (visitElements(body, first, last, [&](int index) { return m_elements[i++] == index; })) {
            return false;
        }
    }
    m_sizes = sizes;
    m_elements.clear();
    visitElements(body, 0, elements, [&](int index) {
        m_elements.push_back(index);
        return true;
    });
    return true;
}

std::shared_ptr<const SoftSurface> SoftEntry::build(const btSoftBody& body) {
    auto made = std::make_shared<SoftSurface>();
    std::vector<Eigen::Vector3f> rest;
    std::vector<Triangle> triangles;
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        rest.push_back(toEigen(body.m_nodes[i].m_x));
    }
    made->nodes = static_cast<std::uint32_t>(rest.size());
    for (const int index : m_elements) {
        if (index < 0 || index >= body.m_nodes.size()) {
            throw Error(Fault::indexOutOfRange,
                        "node " + std::to_string(index) + " of " + std::to_string(body.m_nodes.size()), "soft body");
        }
    }
    if (body.m_tetras.size() > 0) {
        triangles = boundaryOf(m_elements, rest);
        made->solid = true;
    } else if (body.m_faces.size() > 0) {
        for (std::size_t i = 0; i + 2 < m_elements.size(); i += 3) {
            triangles.push_back(triangle(m_elements[i], m_elements[i + 1], m_elements[i + 2]));
        }
    } else {
        made->thread = true;
        for (std::size_t i = 0; i + 1 < m_elements.size(); i += 2) {
            const Eigen::Vector3f from = rest[static_cast<std::size_t>(m_elements[i])];
            const Eigen::Vector3f along = rest[static_cast<std::size_t>(m_elements[i + 1])] - from;
            triangles.push_back(triangle(m_elements[i], m_elements[i + 1], static_cast<int>(rest.size())));
            rest.emplace_back(from + 0.5F * along + 1e-3F * along.unitOrthogonal() * along.norm());
        }
    }
    if (triangles.empty()) {
        throw Error(Fault::emptyMesh, "no faces, tetrahedra or links", "soft body");
    }
    made->tree = buildBallTree({rest, triangles});
    made->owners = ownersOf(triangles, rest.size());
    double sum = 0;
    const Surface& surface = made->tree.surface;
    for (const float square : surface.edgeSquare) {
        sum += std::sqrt(static_cast<double>(square));
    }
    made->meanEdge =
        surface.edges.all.empty() ? 0 : static_cast<float>(sum / static_cast<double>(surface.edges.all.size()));
    return made;
}

std::shared_ptr<const SoftSurface> SoftEntry::surface(const btSoftBody& body, std::uint64_t look) {
    const void* place = body.m_nodes.size() > 0 ? &body.m_nodes[0] : nullptr;
    if (look != 0 && look == m_look && place == m_place && body.m_nodes.size() == m_sizes[0] &&
        body.m_tetras.size() == m_sizes[1] && body.m_faces.size() == m_sizes[2]) {
        return m_surface;
    }
    const bool thoroughly = look == 0 || place != m_place;
    m_look = look;
    m_place = place;
    if (isChanged(body, thoroughly) || (m_surface == nullptr && look == 0)) {
        m_surface.reset();
        m_error.clear();
        try {
            m_surface = build(body);
        } catch (const Error& error) {
            m_error = error.what();
            m_sizes[0] = -1;  // it is read again
        }
    }
    return m_surface;
}

btSoftBody::Face& SoftEntry::face(btSoftBody& body, std::uint32_t triangle) {
    if (body.m_tetras.size() == 0 && static_cast<int>(triangle) < body.m_faces.size()) {
        return body.m_faces[static_cast<int>(triangle)];
    }
    const std::vector<Triangle>& triangles = m_surface->triangles();
    m_faces.resize(triangles.size());  // no face moves while the surface stays
    btSoftBody::Face& face = m_faces[triangle];
    for (std::size_t i = 0; i < 3; ++i) {
        // The middle of a link has no node of its own.
        const std::uint32_t vertex = triangles[triangle][i];
        face.m_n[i] = &body.m_nodes[static_cast<int>(vertex < m_surface->nodes ? vertex : triangles[triangle][0])];
    }
    return face;
}

std::shared_ptr<SoftEntry> SoftEntries::entry(const btSoftBody& body) {
    std::erase_if(m_entries, [](const auto& known) { return known.second.expired(); });
    std::weak_ptr<SoftEntry>& place = m_entries[&body];
    std::shared_ptr<SoftEntry> entry = place.lock();
    if (entry == nullptr) {
        entry = std::make_shared<SoftEntry>();
        place = entry;
    }
    return entry;
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
