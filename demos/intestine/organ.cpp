#include "organ.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <soft/spline_surface.hpp>

namespace grapeshot::intestine {

using Eigen::Vector3d;
using soft::splineRow;

namespace {

constexpr double steepness = 0.03;  // 1 / m
constexpr double folds = 3;         // strands per radian; they lie on rays from the middle
constexpr double innerTurn = 1.7;   // where strands end, m; half circles join them
constexpr double outerTurn = 3.6;
constexpr double firstEnd = 1.45;     // m, of the first strand
constexpr double aboveGround = 0.22;  // of the tube's middle, m
constexpr int around = 12;            // nodes around the tube; a multiple of four
constexpr int across = 4;             // cells of a sheet from strand to strand
constexpr int facing = around / 4;    // where the sheet comes in: on the sides of a fold that face each other
constexpr double slack = 0.04;        // of a sheet, m
constexpr double narrowest = 0.2;     // a sheet ends where the turn leaves it less room, m
constexpr double tubeDensity = 0.6;   // kg per m
constexpr double sheetDensity = 0.4;  // kg per m^2
/// The splines draw a ring of the core in.
const double coreRadius = tubeRadius / (0.75 + 0.25 * std::cos(2 * std::numbers::pi / around));

btVector3 toBullet(const Vector3d& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

class Builder {
  public:
    Builder(std::vector<Vector3d> middles, int fineness)
        : m_middles(std::move(middles)), m_rings(static_cast<int>(m_middles.size())), m_fine(fineness) {}

    Organ build(btSoftBodyWorldInfo& info, double length);

  private:
    int node(const Vector3d& at, double mass) {
        m_points.push_back(at);
        m_masses.push_back(static_cast<btScalar>(mass));
        return static_cast<int>(m_points.size()) - 1;
    }
    void link(int a, int b) { m_links.emplace_back(a, b); }
    [[nodiscard]] static int at(int ring, int k) { return ring * around + (k + around) % around; }
    [[nodiscard]] std::uint32_t fineAt(int ring, int k) const {
        const int n = around * m_fine;
        return static_cast<std::uint32_t>(ring * n + (k + n) % n);
    }
    void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        m_surface.triangles.push_back({a, b, c});
        m_surface.triangles.push_back({a, c, d});
    }
    void addTube(double nodeMass);
    void addTubeSurface();
    /// Between the strands before and after the outer turn whose middle is ring `tip`. False if it is not whole.
    bool addSheet(int tip);
    void addSheetSurface(int tip, int firstRow, int attached, const std::vector<std::array<int, across + 1>>& grid);

    std::vector<Vector3d> m_middles;
    int m_rings;
    int m_fine;
    std::vector<Vector3d> m_points;
    std::vector<btScalar> m_masses;
    std::vector<std::pair<int, int>> m_links;
    soft::CarriedSurface m_surface;
};

void Builder::addTube(double nodeMass) {
    for (int i = 0; i < m_rings; ++i) {
        const Vector3d ahead = m_middles[static_cast<std::size_t>(std::min(i + 1, m_rings - 1))];
        const Vector3d behind = m_middles[static_cast<std::size_t>(std::max(i - 1, 0))];
        const Vector3d along = (ahead - behind).normalized();
        const Vector3d side = along.cross(Vector3d::UnitY()).normalized();
        const Vector3d up = side.cross(along);
        for (int k = 0; k < around; ++k) {
            const double angle = 2 * std::numbers::pi * k / around;
            node(m_middles[static_cast<std::size_t>(i)] + coreRadius * (std::sin(angle) * side - std::cos(angle) * up),
                 nodeMass);
        }
    }
    for (int i = 0; i < m_rings; ++i) {
        for (int k = 0; k < around; ++k) {
            link(at(i, k), at(i, k + 1));
            link(at(i, k), at(i, k + 2));
            if (i + 1 < m_rings) {
                link(at(i, k), at(i + 1, k));
                link(at(i, k), at(i + 1, k + 1));
                link(at(i, k + 1), at(i + 1, k));
            }
            if (i + 2 < m_rings) {
                link(at(i, k), at(i + 2, k));  // against kinks
            }
            if (k < around / 2) {
                link(at(i, k), at(i, k + around / 2));  // what fills the tube keeps it open
            }
        }
    }
    for (const int end : {0, m_rings - 1}) {
        const int centre = node(m_middles[static_cast<std::size_t>(end)], nodeMass);
        for (int k = 0; k < around; ++k) {
            link(centre, at(end, k));
        }
    }
}

void Builder::addTubeSurface() {
    const int fineRings = (m_rings - 1) * m_fine;
    for (int i = 0; i <= fineRings; ++i) {
        const soft::SplineRow u = splineRow(static_cast<double>(i) / m_fine, m_rings, false);
        for (int k = 0; k < around * m_fine; ++k) {
            addVertex(m_surface, u, splineRow(static_cast<double>(k) / m_fine, around, true),
                      [](int ring, int column) { return at(ring, column); });
        }
    }
    for (int i = 0; i < fineRings; ++i) {
        for (int k = 0; k < around * m_fine; ++k) {
            quad(fineAt(i, k), fineAt(i + 1, k), fineAt(i + 1, k + 1), fineAt(i, k + 1));
        }
    }
    for (int end = 0; end < 2; ++end) {
        const auto centre = static_cast<std::uint32_t>(m_rings * around + end);
        m_surface.shares.push_back({centre, 1});
        m_surface.ends.push_back(static_cast<std::uint32_t>(m_surface.shares.size()));
        const std::uint32_t middle = m_surface.vertices() - 1;
        const int ring = end == 0 ? 0 : fineRings;
        for (int k = 0; k < around * m_fine; ++k) {
            m_surface.triangles.push_back(
                {middle, fineAt(ring, end == 0 ? k : k + 1), fineAt(ring, end == 0 ? k + 1 : k)});
        }
    }
}

bool Builder::addSheet(int tip) {
    const auto reaches = [&](int d) { return tip - d >= 0 && tip + d < m_rings; };
    const auto chord = [&](int d) {
        return (m_points[static_cast<std::size_t>(at(tip - d, facing))] -
                m_points[static_cast<std::size_t>(at(tip + d, facing))])
            .norm();
    };
    const auto radius = [&](int d) {
        const Vector3d& middle = m_middles[static_cast<std::size_t>(tip - d)];
        return std::hypot(middle.x(), middle.z());
    };
    int first = 1;
    while (reaches(first) && chord(first) < narrowest) {
        ++first;
    }
    int last = first;
    while (reaches(last + 1) && radius(last + 1) >= innerTurn) {
        ++last;
    }
    if (!reaches(last + 1)) {
        return false;
    }
    const double cell = (m_middles[1] - m_middles[0]).norm();
    std::vector<std::array<int, across + 1>> grid;
    const auto addRow = [&](const Vector3d& from, const Vector3d& to, bool sewn, int d, double mass) {
        std::array<int, across + 1> row{};
        for (int c = 0; c <= across; ++c) {
            const double t = static_cast<double>(c) / across;
            if (sewn && (c == 0 || c == across)) {
                row[static_cast<std::size_t>(c)] = c == 0 ? at(tip - d, facing) : at(tip + d, facing);
                continue;
            }
            row[static_cast<std::size_t>(c)] =
                node(from + t * (to - from) - slack * std::sin(std::numbers::pi * t) * Vector3d::UnitY(), mass);
        }
        grid.push_back(row);
    };
    for (int d = first; d <= last; ++d) {
        const Vector3d from = m_points[static_cast<std::size_t>(at(tip - d, facing))];
        const Vector3d to = m_points[static_cast<std::size_t>(at(tip + d, facing))];
        addRow(from, to, true, d, sheetDensity * cell * (to - from).norm() / (across - 1));
    }
    // From there a narrowing strip to the root.
    const Vector3d from = m_points[static_cast<std::size_t>(at(tip - last, facing))];
    const Vector3d to = m_points[static_cast<std::size_t>(at(tip + last, facing))];
    const Vector3d inward = -Vector3d(from.x() + to.x(), 0, from.z() + to.z()).normalized();
    const double way = radius(last) - rootRadius;
    const int rows = std::max(2, static_cast<int>(std::lround(way / cell)));
    for (int i = 1; i <= rows; ++i) {
        const double t = static_cast<double>(i) / rows;
        const double narrow = 0.25 * std::min(1.0, 4 * t);
        const auto moved = [&](const Vector3d& start, const Vector3d& other) {
            Vector3d place = start + narrow * (other - start) + t * way * inward;
            place.y() = (1 - t) * start.y() + t * (groundAt(rootRadius, 0) + aboveGround);
            return place;
        };
        addRow(moved(from, to), moved(to, from), false, 0,
               i == rows ? 0 : sheetDensity * cell * (to - from).norm() / (across + 1));
    }
    for (std::size_t i = 0; i < grid.size(); ++i) {
        for (std::size_t c = 0; c <= across; ++c) {
            if (c < across) {
                link(grid[i][c], grid[i][c + 1]);
            }
            if (i + 1 < grid.size()) {
                const bool sewn = static_cast<int>(i) + first < last && (c == 0 || c == across);
                if (!sewn) {
                    link(grid[i][c], grid[i + 1][c]);
                }
                if (c < across) {
                    link(grid[i][c], grid[i + 1][c + 1]);
                    link(grid[i][c + 1], grid[i + 1][c]);
                }
            }
            // Against folds that are sharper than its cells.
            if (c + 2 <= across) {
                link(grid[i][c], grid[i][c + 2]);
            }
            if (i + 2 < grid.size()) {
                link(grid[i][c], grid[i + 2][c]);
            }
        }
        // Its coat goes on around the tube.
        const int d = first + static_cast<int>(i);
        for (const int aside : {-2, 2}) {
            if (d <= last) {
                link(grid[i][1], at(tip - d, facing + aside));
                link(grid[i][across - 1], at(tip + d, facing + aside));
            }
        }
    }
    addSheetSurface(tip, first, last - first, grid);
    return true;
}

void Builder::addSheetSurface(int tip, int firstRow, int attached,
                              const std::vector<std::array<int, across + 1>>& grid) {
    const int rows = static_cast<int>(grid.size());
    std::vector<std::vector<std::uint32_t>> fine;
    for (int i = 0; i <= (rows - 1) * m_fine; ++i) {
        const bool sewn = i <= attached * m_fine;
        const soft::SplineRow u = splineRow(static_cast<double>(i) / m_fine, rows, false);
        std::vector<std::uint32_t>& row = fine.emplace_back();
        for (int c = 0; c <= across * m_fine; ++c) {
            if (sewn && (c == 0 || c == across * m_fine)) {
                const int ring = c == 0 ? (tip - firstRow) * m_fine - i : (tip + firstRow) * m_fine + i;
                row.push_back(fineAt(ring, facing * m_fine));
                continue;
            }
            row.push_back(addVertex(m_surface, u, splineRow(static_cast<double>(c) / m_fine, across + 1, false),
                                    [&](int r, int column) {
                                        return grid[static_cast<std::size_t>(r)][static_cast<std::size_t>(column)];
                                    }));
        }
    }
    for (std::size_t i = 0; i + 1 < fine.size(); ++i) {
        for (std::size_t c = 0; c + 1 < fine[i].size(); ++c) {
            quad(fine[i][c], fine[i][c + 1], fine[i + 1][c + 1], fine[i + 1][c]);
        }
    }
}

Organ Builder::build(btSoftBodyWorldInfo& info, double length) {
    addTube(tubeDensity * length / (m_rings * around));
    addTubeSurface();
    const auto radiusOf = [&](int i) {
        const Vector3d& middle = m_middles[static_cast<std::size_t>(i)];
        return std::hypot(middle.x(), middle.z());
    };
    for (int i = 1; i + 1 < m_rings; ++i) {
        if (radiusOf(i) > outerTurn && radiusOf(i) >= radiusOf(i - 1) && radiusOf(i) > radiusOf(i + 1)) {
            addSheet(i);
        }
    }
    std::vector<btVector3> points;
    for (const Vector3d& point : m_points) {
        points.push_back(toBullet(point));
    }
    Organ organ;
    organ.core = std::make_unique<btSoftBody>(&info, static_cast<int>(points.size()), points.data(), m_masses.data());
    for (const auto& [a, b] : m_links) {
        organ.core->appendLink(a, b);
    }
    organ.core->m_cfg.collisions = 0;
    organ.surface = std::move(m_surface);
    organ.rings = m_rings;
    organ.around = around;
    const double half = 0.5 * (innerTurn + outerTurn);
    for (int i = 1; i < m_rings; ++i) {
        if (radiusOf(i - 1) < half && radiusOf(i) >= half &&
            std::abs(2 * i - m_rings) < std::abs(2 * organ.strand - m_rings)) {
            organ.strand = i;
        }
    }
    return organ;
}

}  // namespace

double groundAt(double x, double z) {
    return steepness * (x * x + z * z);
}

std::vector<Vector3d> coil(double length, double spacing) {
    const int count = std::max(8, static_cast<int>(std::lround(length / spacing)));
    const double step = length / count;
    const double half = 0.5 / folds;  // rad, between a strand and the middle of its turn
    constexpr int pieces = 1000;      // of each strand and turn
    std::vector<Vector3d> points;
    double gone = 0;
    Vector3d last = Vector3d::Zero();
    const auto pass = [&](double radius, double angle) {
        const double x = radius * std::cos(angle);
        const double z = radius * std::sin(angle);
        const Vector3d next(x, groundAt(x, z) + aboveGround, z);
        gone += points.empty() ? 0 : (next - last).norm();
        last = next;
        if (gone >= step * static_cast<double>(points.size()) && static_cast<int>(points.size()) <= count) {
            points.push_back(next);
        }
    };
    for (int strand = 0; static_cast<int>(points.size()) <= count; ++strand) {
        const bool outward = strand % 2 == 0;
        const double from = strand == 0 ? firstEnd : (outward ? innerTurn : outerTurn);
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
    Builder builder(coil(settings.length, 2 * std::numbers::pi * tubeRadius / around), settings.fineness);
    Organ organ = builder.build(info, settings.length);
    btSoftBody& body = *organ.core;
    body.m_materials[0]->m_kLST = btScalar(0.8);
    // In its fluid nothing moves fast.
    body.m_cfg.kDP = btScalar(0.25);
    body.updateConstants();
    return organ;
}

}  // namespace grapeshot::intestine
