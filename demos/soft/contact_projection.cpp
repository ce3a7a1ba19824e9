#include "contact_projection.hpp"

#include <algorithm>

namespace grapeshot::soft {

using Eigen::Vector3d;

namespace {

/// Where the contact is to be at the end of the step, m.
double targetOf(double before, double thickness) {
    const double slow = before + 0.2 * thickness;
    return std::min(thickness, before < 0 ? std::max(slow, 0.5 * before) : slow);
}

}  // namespace

Vector3d placeOf(const CarriedSurface& surface, std::uint32_t vertex, const std::vector<Vector3d>& nodes) {
    Vector3d place = Vector3d::Zero();
    for (std::uint32_t k = surface.begin(vertex); k < surface.ends[vertex]; ++k) {
        place += static_cast<double>(surface.shares[k].weight) * nodes[surface.shares[k].node];
    }
    return place;
}

CarriedSurface ownSurface(const btSoftBody& body) {
    CarriedSurface surface;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(body.m_nodes.size()); ++i) {
        surface.shares.push_back({i, 1});
        surface.ends.push_back(i + 1);
    }
    for (int i = 0; i < body.m_faces.size(); ++i) {
        const auto corner = [&](int k) {
            return static_cast<std::uint32_t>(body.m_faces[i].m_n[k] - &body.m_nodes[0]);
        };
        surface.triangles.push_back({corner(0), corner(1), corner(2)});
    }
    return surface;
}

void ContactProjection::read(const CarriedSurface& surface, const std::vector<SurfaceContact>& contacts,
                             const CoreNodes& nodes, double thickness) {
    m_ends.clear();
    m_points.clear();
    std::vector<End> ends;
    for (const SurfaceContact& contact : contacts) {
        ends.clear();
        const auto add = [&](const std::array<int, 3>& vertices, const std::array<float, 3>& weights, double sign) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (vertices[i] < 0) {
                    continue;
                }
                const auto vertex = static_cast<std::uint32_t>(vertices[i]);
                for (std::uint32_t k = surface.begin(vertex); k < surface.ends[vertex]; ++k) {
                    const CarriedSurface::Share& share = surface.shares[k];
                    ends.push_back(
                        {share.node, sign * static_cast<double>(weights[i]) * static_cast<double>(share.weight), 0});
                }
            }
        };
        add(contact.a, contact.weightsA, 1);
        add(contact.b, contact.weightsB, -1);
        std::sort(ends.begin(), ends.end(), [](const End& x, const End& y) { return x.node < y.node; });
        const auto begin = static_cast<std::uint32_t>(m_ends.size());
        double response = 0;
        for (std::size_t i = 0; i < ends.size();) {
            End sum{ends[i].node, 0, 0};
            for (; i < ends.size() && ends[i].node == sum.node; ++i) {
                sum.weight += ends[i].weight;
            }
            sum.response = sum.weight * nodes.inverseMass[sum.node];
            response += sum.weight * sum.response;
            m_ends.push_back(sum);
        }
        // Two points of one and the same piece of the coarse body cannot be parted by moving it.
        if (!(response > 1e-6)) {
            m_ends.resize(begin);
            continue;
        }
        m_points.push_back({begin, static_cast<std::uint32_t>(m_ends.size()), contact.normal,
                            targetOf(contact.before, thickness) + contact.offset, 1 / response, 0, contact.rigid});
    }
}

void ContactProjection::pass(CoreNodes& nodes) {
    for (Point& point : m_points) {
        Vector3d gap = Vector3d::Zero();
        for (std::uint32_t i = point.begin; i < point.end; ++i) {
            gap += m_ends[i].weight * nodes.now[m_ends[i].node];
        }
        const double push = std::max(0.0, point.push + (point.target - gap.dot(point.normal)) * point.scale);
        const double change = push - point.push;
        if (change == 0) {
            continue;
        }
        point.push = push;
        for (std::uint32_t i = point.begin; i < point.end; ++i) {
            nodes.now[m_ends[i].node] += change * m_ends[i].response * point.normal;
        }
    }
}

void ContactProjection::rub(CoreNodes& nodes, double friction) {
    for (const Point& point : m_points) {
        if (point.rigid || point.push <= 0) {
            continue;
        }
        Vector3d way = Vector3d::Zero();
        for (std::uint32_t i = point.begin; i < point.end; ++i) {
            const std::uint32_t node = m_ends[i].node;
            way += m_ends[i].weight * (nodes.now[node] - nodes.before[node]);
        }
        way -= way.dot(point.normal) * point.normal;
        const double length = way.norm();
        if (length > 0) {
            const Vector3d back = -std::min(length * point.scale, friction * point.push) / length * way;
            for (std::uint32_t i = point.begin; i < point.end; ++i) {
                nodes.now[m_ends[i].node] += m_ends[i].response * back;
            }
        }
    }
}

Vector3d ContactProjection::pushOnRigid() const {
    Vector3d sum = Vector3d::Zero();
    for (const Point& point : m_points) {
        sum -= (point.rigid ? point.push : 0.0) * point.normal;
    }
    return sum;
}

}  // namespace grapeshot::soft
