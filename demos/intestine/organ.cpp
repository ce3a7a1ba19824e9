#include "organ.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace grapeshot::intestine {

using Eigen::Vector3d;

namespace {

constexpr double height = 1.0;     // of the start above the ground, m
constexpr double folds = 3.6;      // strands per radian; they lie on rays from the middle
constexpr double innerTurn = 1.7;  // where strands end, m; half circles join them
constexpr double outerTurn = 3.6;
constexpr double rootRadius = 0.7;    // where the mesentery is fixed, m
constexpr int sheetRows = 10;         // from the root to the tube
constexpr double tubeDensity = 0.6;   // kg per m
constexpr double sheetDensity = 0.4;  // kg per m^2

btVector3 toBullet(const Vector3d& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

/// Nodes, links and faces before Bullet has them.
struct Plan {
    std::vector<btVector3> points;
    std::vector<btScalar> masses;
    std::vector<std::pair<int, int>> links;
    std::vector<std::array<int, 3>> faces;

    int node(const Vector3d& at, double mass) {
        points.push_back(toBullet(at));
        masses.push_back(static_cast<btScalar>(mass));
        return static_cast<int>(points.size()) - 1;
    }
    void quad(int a, int b, int c, int d) {
        faces.push_back({a, b, c});
        faces.push_back({a, c, d});
        links.emplace_back(a, c);
    }
};

void addTube(Plan& plan, const std::vector<Vector3d>& middles, int around, double nodeMass) {
    const int rings = static_cast<int>(middles.size());
    for (int i = 0; i < rings; ++i) {
        const Vector3d ahead = middles[static_cast<std::size_t>(std::min(i + 1, rings - 1))];
        const Vector3d behind = middles[static_cast<std::size_t>(std::max(i - 1, 0))];
        const Vector3d side = (ahead - behind).normalized().cross(Vector3d::UnitY());
        for (int k = 0; k < around; ++k) {
            // Vertex 0 is at the bottom, where the mesentery comes in.
            const double angle = 2 * std::numbers::pi * k / around;
            plan.node(middles[static_cast<std::size_t>(i)] +
                          tubeRadius * (std::sin(angle) * side - std::cos(angle) * Vector3d::UnitY()),
                      nodeMass);
        }
    }
    const auto at = [&](int i, int k) { return i * around + (k + around) % around; };
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < around; ++k) {
            plan.links.emplace_back(at(i, k), at(i, k + 1));
            if (i + 1 < rings) {
                plan.links.emplace_back(at(i, k), at(i + 1, k));
                plan.quad(at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
            }
            if (i + 2 < rings) {
                plan.links.emplace_back(at(i, k), at(i + 2, k));  // against kinks
            }
            if (k < around / 2) {
                plan.links.emplace_back(at(i, k), at(i, k + around / 2));  // what fills the tube keeps it open
            }
            plan.links.emplace_back(at(i, k), at(i, k + 2));
        }
    }
    for (const int end : {0, rings - 1}) {
        const int centre = plan.node(middles[static_cast<std::size_t>(end)], nodeMass);
        for (int k = 0; k < around; ++k) {
            const int next = end == 0 ? k + 1 : k - 1;
            plan.faces.push_back({centre, at(end, k), at(end, next)});
            plan.links.emplace_back(centre, at(end, k));
        }
    }
}

/// Where the sheet to a point of the tube begins: it fans out from between the two strands of a fold, so that it lies
/// nowhere on itself.
double rootAngle(const Vector3d& at) {
    double angle = std::atan2(at.z(), at.x());
    angle += angle < 0 ? 2 * std::numbers::pi : 0;
    const double fold = 2 / folds;
    const double centre = fold * (std::round(angle / fold - 0.5) + 0.5);
    const double outward = std::clamp((std::hypot(at.x(), at.z()) - innerTurn) / (outerTurn - innerTurn), 0.0, 1.0);
    return centre + (angle - centre) * (1 - 0.6 * outward);
}

void addSheet(Plan& plan, const std::vector<Vector3d>& middles, int around, double nodeMass) {
    const int rings = static_cast<int>(middles.size());
    const int first = static_cast<int>(plan.points.size());
    const auto at = [&](int i, int row) { return row == sheetRows ? i * around : first + i * sheetRows + row; };
    for (const Vector3d& centre : middles) {
        const Vector3d end = centre - tubeRadius * Vector3d::UnitY();
        const double angle = rootAngle(end);
        const Vector3d root(rootRadius * std::cos(angle), end.y(), rootRadius * std::sin(angle));
        for (int row = 0; row < sheetRows; ++row) {
            const double t = static_cast<double>(row) / sheetRows;
            const Vector3d slack = 0.2 * std::sin(std::numbers::pi * t) * Vector3d::UnitY();
            plan.node(root + t * (end - root) - slack, row == 0 ? 0 : nodeMass);
        }
    }
    for (int i = 0; i < rings; ++i) {
        for (int row = 0; row < sheetRows; ++row) {
            plan.links.emplace_back(at(i, row), at(i, row + 1));
            if (i + 1 < rings) {
                if (row > 0) {
                    plan.links.emplace_back(at(i, row), at(i + 1, row));
                }
                plan.quad(at(i, row), at(i, row + 1), at(i + 1, row + 1), at(i + 1, row));
            }
        }
    }
}

double sheetArea(const std::vector<Vector3d>& middles) {
    double area = 0;
    for (std::size_t i = 1; i < middles.size(); ++i) {
        const Vector3d a(middles[i - 1].x(), 0, middles[i - 1].z());
        const Vector3d b(middles[i].x(), 0, middles[i].z());
        area += 0.5 * a.cross(b).norm();
    }
    return area;
}

}  // namespace

std::vector<Vector3d> coil(double length, double spacing) {
    const int count = std::max(8, static_cast<int>(std::lround(length / spacing)));
    const double step = length / count;
    const double half = 0.5 / folds;  // rad, between a strand and the middle of its turn
    constexpr int pieces = 1000;      // of each strand and turn
    std::vector<Vector3d> points;
    double gone = 0;
    Vector3d last = Vector3d::Zero();
    const auto pass = [&](double radius, double angle) {
        const Vector3d next(radius * std::cos(angle), height, radius * std::sin(angle));
        gone += points.empty() ? 0 : (next - last).norm();
        last = next;
        if (gone >= step * static_cast<double>(points.size()) && static_cast<int>(points.size()) <= count) {
            points.push_back(next);
        }
    };
    for (int strand = 0; static_cast<int>(points.size()) <= count; ++strand) {
        const bool outward = strand % 2 == 0;
        const double from = outward ? innerTurn : outerTurn;
        const double to = outward ? outerTurn : innerTurn;
        const double angle = (2 * strand + 1) * half;
        for (int i = 0; i < pieces; ++i) {
            pass(from + (to - from) * i / pieces, angle);
        }
        // A circle that touches this strand's ray and the next one's.
        const double centre = to / std::cos(half);
        const double radius = to * std::tan(half);
        const double reach = std::numbers::pi / 2 + (outward ? half : -half);
        for (int i = 0; i < pieces; ++i) {
            const double turn = reach * (2.0 * i / pieces - 1);
            const double x = centre + (outward ? 1 : -1) * radius * std::cos(turn);
            const double y = radius * std::sin(turn);
            pass(std::hypot(x, y), angle + half + std::atan2(y, x));
        }
    }
    return points;
}

Organ makeOrgan(btSoftBodyWorldInfo& info, const OrganSettings& settings) {
    const int around = settings.around;
    const std::vector<Vector3d> middles = coil(settings.length, 2 * std::numbers::pi * tubeRadius / around);
    const auto rings = static_cast<double>(middles.size());
    Plan plan;
    addTube(plan, middles, around, tubeDensity * settings.length / (rings * around));
    const std::size_t tubeTriangles = plan.faces.size();
    addSheet(plan, middles, around, sheetDensity * sheetArea(middles) / (rings * sheetRows));

    Organ organ;
    organ.body = std::make_unique<btSoftBody>(&info, static_cast<int>(plan.points.size()), plan.points.data(),
                                              plan.masses.data());
    organ.rings = static_cast<int>(middles.size());
    organ.around = around;
    organ.tubeTriangles = tubeTriangles;
    btSoftBody& body = *organ.body;
    for (const auto& [a, b] : plan.links) {
        body.appendLink(a, b);
    }
    for (const auto& face : plan.faces) {
        body.appendFace(face[0], face[1], face[2]);
    }
    body.m_materials[0]->m_kLST = btScalar(0.8);
    body.m_cfg.piterations = 6;
    body.m_cfg.kDP = btScalar(0.02);
    body.m_cfg.kDF = btScalar(0.2);
    // Bodies of one's own meet without a flag; this one is for Bullet's own with rigid bodies.
    body.m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
    body.updateConstants();
    return organ;
}

}  // namespace grapeshot::intestine
