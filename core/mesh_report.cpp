#include <grapeshot/core/mesh_report.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <vector>

#include <grapeshot/core/detail/half_edges.hpp>
#include <grapeshot/core/detail/welding.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_slices.hpp>

namespace grapeshot {

namespace {

/// Indices and node references are 31 bit.
constexpr std::size_t largestCount = 0x7ffffffeU;
constexpr double leastRelativeHeight = 1e-6;

using Eigen::Vector3d;

/// Twice the area vector, relative to the first corner.
Vector3d areaVector(const std::array<Vector3d, 3>& corner) {
    return (corner[1] - corner[0]).cross(corner[2] - corner[0]);
}

bool isDegenerate(const std::array<Vector3d, 3>& corner) {
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        longest = std::max(longest, (corner[(i + 1) % 3] - corner[i]).norm());
    }
    return !(areaVector(corner).norm() > leastRelativeHeight * longest * longest);
}

std::array<Vector3d, 3> cornersOf(MeshView mesh, const Triangle& triangle) {
    return {mesh.vertices[triangle[0]].cast<double>(), mesh.vertices[triangle[1]].cast<double>(),
            mesh.vertices[triangle[2]].cast<double>()};
}

/// Disjoint sets of vertices.
class Pieces {
  public:
    void reserve(std::size_t size) { m_parent.reserve(size); }
    void grow(std::size_t size) {
        while (m_parent.size() < size) {
            m_parent.push_back(static_cast<std::uint32_t>(m_parent.size()));
        }
    }
    std::uint32_t find(std::uint32_t v) {
        while (m_parent[v] != v) {
            m_parent[v] = m_parent[m_parent[v]];
            v = m_parent[v];
        }
        return v;
    }
    void unite(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t rootA = find(a);
        const std::uint32_t rootB = find(b);
        m_parent[std::max(rootA, rootB)] = std::min(rootA, rootB);
    }

  private:
    std::vector<std::uint32_t> m_parent;
};

constexpr std::size_t perUnit = 16;  // of most loops below

/// Triangles with three good corners; counts the bad ones.
Sliced findSoundTriangles(MeshView mesh, MeshReport& report, std::vector<Triangle>& sound) {
    sound.reserve(mesh.triangles.size());
    const auto sift = [&](std::size_t begin, std::size_t end) {
        for (const Triangle& triangle : mesh.triangles.subspan(begin, end - begin)) {
            bool good = true;
            for (const std::uint32_t v : triangle) {
                if (v >= mesh.vertices.size()) {
                    ++report.indicesOutOfRange;
                    good = false;
                } else if (!mesh.vertices[v].allFinite()) {
                    good = false;
                }
            }
            if (good) {
                sound.push_back(triangle);
            }
        }
    };
    co_await inPieces(0, mesh.triangles.size(), perUnit, sift);
}

Sliced measureVertices(MeshView mesh, const std::vector<std::uint32_t>& welded, MeshReport& report) {
    std::vector<bool> named(mesh.vertices.size(), false);  // an eighth of a byte each: cheap at once
    const auto name = [&](std::size_t begin, std::size_t end) {
        for (const Triangle& triangle : mesh.triangles.subspan(begin, end - begin)) {
            for (const std::uint32_t v : triangle) {
                if (v < named.size()) {
                    named[v] = true;
                }
            }
        }
    };
    co_await inPieces(0, mesh.triangles.size(), perUnit, name);
    const auto count = [&](std::size_t begin, std::size_t end) {
        for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
            report.notFiniteVertices += mesh.vertices[v].allFinite() ? 0U : 1U;
            report.unusedVertices += named[v] ? 0U : 1U;
            report.distinctVertices += welded[v] == v ? 1U : 0U;
        }
    };
    co_await inPieces(0, mesh.vertices.size(), perUnit, count);
}

Sliced measureEdges(const std::vector<Triangle>& sound, const std::vector<std::uint32_t>& welded, MeshReport& report) {
    std::vector<detail::HalfEdge> edges;
    co_await detail::sortHalfEdgesInSlices(sound, welded, edges);
    report.closed = !edges.empty();
    for (std::size_t begin = 0; begin < edges.size();) {
        co_yield mostSlicedPiece;
        for (const std::size_t pause = begin + 64 * mostSlicedPiece; begin < std::min(pause, edges.size());) {
            const std::size_t end = detail::endOfEdge(edges, begin);
            if (end - begin == 1) {
                ++report.boundaryEdges;
            } else if (end - begin > 2) {
                ++report.nonManifoldEdges;
            } else if (!detail::isOrientedPair(edges, begin, end)) {
                ++report.misorientedEdges;
            }
            report.closed = report.closed && detail::isOrientedPair(edges, begin, end) &&
                            edges[begin].triangle != edges[begin + 1].triangle;
            begin = end;
        }
    }
}

Sliced measureSurface(MeshView mesh, const std::vector<Triangle>& sound, const std::vector<std::uint32_t>& welded,
                      MeshReport& report) {
    if (sound.empty()) {
        co_return;
    }
    Pieces pieces;
    pieces.reserve(mesh.vertices.size());
    const auto begin = [&](std::size_t, std::size_t end) { pieces.grow(end); };
    co_await inPieces(0, mesh.vertices.size(), 512, begin);
    Eigen::Vector3f lower = mesh.vertices[sound[0][0]];
    Eigen::Vector3f upper = lower;
    double shortest = std::numeric_limits<double>::infinity();
    const Vector3d origin = lower.cast<double>();  // volume about a point of the mesh: no cancellation far from 0
    const auto measure = [&](std::size_t first, std::size_t last) {
        for (std::size_t t = first; t < last; ++t) {
            const Triangle& triangle = sound[t];
            const std::array<Vector3d, 3> corner = cornersOf(mesh, triangle);
            for (std::size_t i = 0; i < 3; ++i) {
                lower = lower.cwiseMin(mesh.vertices[triangle[i]]);
                upper = upper.cwiseMax(mesh.vertices[triangle[i]]);
                const double length = (corner[(i + 1) % 3] - corner[i]).norm();
                if (length > 0) {
                    shortest = std::min(shortest, length);
                }
            }
            pieces.unite(welded[triangle[0]], welded[triangle[1]]);
            pieces.unite(welded[triangle[0]], welded[triangle[2]]);
            const Vector3d twiceArea = areaVector(corner);
            report.degenerateTriangles += isDegenerate(corner) ? 1U : 0U;
            report.area += 0.5 * twiceArea.norm();
            report.volume += (corner[0] - origin).dot(twiceArea) / 6.0;
        }
    };
    co_await inPieces(0, sound.size(), 4, measure);
    std::vector<bool> counted(mesh.vertices.size(), false);
    const auto count = [&](std::size_t first, std::size_t last) {
        for (std::size_t t = first; t < last; ++t) {
            const std::uint32_t root = pieces.find(welded[sound[t][0]]);
            report.pieces += counted[root] ? 0U : 1U;
            counted[root] = true;
        }
    };
    co_await inPieces(0, sound.size(), perUnit, count);
    report.lower = lower;
    report.upper = upper;
    if (std::isfinite(shortest)) {
        const double largest = static_cast<double>(std::max(lower.cwiseAbs().maxCoeff(), upper.cwiseAbs().maxCoeff()));
        report.relativePrecision = largest * 0x1p-24 / shortest;
    }
}

std::string text(double value) {
    std::ostringstream stream;
    stream << std::setprecision(6) << value;
    return stream.str();
}

std::string text(const Eigen::Vector3f& v) {
    std::ostringstream stream;
    stream << std::setprecision(6) << '(' << v.x() << ", " << v.y() << ", " << v.z() << ')';
    return stream.str();
}

}  // namespace

Sliced inspectInSlices(MeshView mesh, MeshReport& report) {
    report = MeshReport();
    report.vertices = mesh.vertices.size();
    report.triangles = mesh.triangles.size();
    std::vector<std::uint32_t> welded;
    co_await detail::weldInSlices(mesh.vertices, welded);
    std::vector<Triangle> sound;
    co_await findSoundTriangles(mesh, report, sound);
    co_await measureVertices(mesh, welded, report);
    co_await measureEdges(sound, welded, report);
    co_await measureSurface(mesh, sound, welded, report);
}

MeshReport inspect(MeshView mesh) {
    MeshReport report;
    inspectInSlices(mesh, report).run();
    return report;
}

std::string describe(const MeshReport& report) {
    std::ostringstream out;
    out << report.triangles << " triangles, " << report.vertices << " vertices";
    if (report.distinctVertices != report.vertices) {
        out << " (" << report.distinctVertices << " distinct positions)";
    }
    out << '\n';
    const auto finding = [&](std::size_t count, const char* what) {
        if (count != 0) {
            out << count << ' ' << what << '\n';
        }
    };
    finding(report.notFiniteVertices, "vertices are NaN or infinite");
    finding(report.indicesOutOfRange, "triangle corners name no vertex");
    finding(report.unusedVertices, "vertices are used by no triangle");
    finding(report.degenerateTriangles, "triangles are degenerate");
    finding(report.boundaryEdges, "edges are open (one triangle)");
    finding(report.nonManifoldEdges, "edges are non-manifold (three or more triangles)");
    finding(report.misorientedEdges, "edges join triangles of opposite orientation");
    out << report.pieces << (report.pieces == 1 ? " piece, " : " pieces, ")
        << (report.closed ? "closed" : "not closed");
    if (report.closed) {
        out << ", volume " << text(report.volume) << " m^3" << (report.volume < 0 ? " (inside out)" : "");
    }
    out << ", area " << text(report.area) << " m^2\n";
    out << "box " << text(report.lower) << " to " << text(report.upper) << " m\n";
    if (report.relativePrecision > 0.01) {
        out << "too far from the origin for single precision: rounding is " << text(100 * report.relativePrecision)
            << " % of the shortest edge\n";
    }
    return out.str();
}

Sliced requireUsableInSlices(MeshView mesh) {
    const auto count = [](std::size_t n) { return std::to_string(n); };
    if (mesh.vertices.empty() || mesh.triangles.empty()) {
        throw Error(Fault::emptyMesh,
                    count(mesh.vertices.size()) + " vertices and " + count(mesh.triangles.size()) + " triangles",
                    "mesh");
    }
    if (mesh.vertices.size() > largestCount || mesh.triangles.size() > largestCount) {
        throw Error(Fault::tooLarge,
                    count(mesh.vertices.size()) + " vertices and " + count(mesh.triangles.size()) +
                        " triangles, limit " + count(largestCount),
                    "mesh");
    }
    const auto checkVertices = [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const Eigen::Vector3f& vertex = mesh.vertices[v];
            if (!vertex.allFinite()) {
                throw Error(Fault::notFinite, text(vertex), "vertex " + count(v));
            }
            if (vertex.cwiseAbs().maxCoeff() > largestCoordinate) {
                throw Error(Fault::tooLarge, text(vertex) + ", limit 1e15", "vertex " + count(v));
            }
        }
    };
    co_await inPieces(0, mesh.vertices.size(), 64, checkVertices);
    bool surface = false;
    const auto checkTriangles = [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            for (const std::uint32_t v : mesh.triangles[t]) {
                if (v >= mesh.vertices.size()) {
                    throw Error(Fault::indexOutOfRange, count(v) + " of " + count(mesh.vertices.size()) + " vertices",
                                "triangle " + count(t));
                }
            }
            surface = surface || !isDegenerate(cornersOf(mesh, mesh.triangles[t]));
        }
    };
    co_await inPieces(0, mesh.triangles.size(), 64, checkTriangles);
    if (!surface) {
        throw Error(Fault::noSurface, "all " + count(mesh.triangles.size()) + " triangles are degenerate", "mesh");
    }
}

void requireUsable(MeshView mesh) {
    requireUsableInSlices(mesh).run();
}

}  // namespace grapeshot
