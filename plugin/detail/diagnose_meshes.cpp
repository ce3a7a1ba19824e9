// Triangles, scale and margin of each mesh shape.
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/plugin/detail/convert.hpp>
#include <grapeshot/plugin/detail/diagnosis_parts.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/shape_mesh.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

namespace {

/// A mesh shape, and the body it was met in first: a moving one if there is one.
struct Use {
    const btCollisionShape* shape = nullptr;
    int body = -1;
    bool moves = false;
};

std::vector<Use> usesOf(const Patient& patient) {
    std::vector<Use> uses;
    std::unordered_map<const btCollisionShape*, std::size_t> known;
    for (std::size_t i = 0; i < patient.bodies.size(); ++i) {
        const Patient::Body& body = patient.bodies[i];
        for (const PlacedShape& leaf : body.leaves) {
            if (!isMesh(*leaf.shape)) {
                continue;
            }
            const auto [place, isNew] = known.emplace(leaf.shape, uses.size());
            if (isNew) {
                uses.push_back({leaf.shape, static_cast<int>(i), body.moves});
            } else if (body.moves && !uses[place->second].moves) {
                uses[place->second].body = static_cast<int>(i);
                uses[place->second].moves = true;
            }
        }
    }
    return uses;
}

/// As it was set: marginOf clears what is no margin. A GImpact mesh's margin is kept in its parts.
btScalar rawMargin(const btCollisionShape& shape) {
    const btScalar own = shape.getMargin();
    if (!isGImpact(shape) || !(own >= 0)) {
        return own;
    }
    const auto& whole = static_cast<const btGImpactShapeInterface&>(shape);
    if (whole.getGImpactShapeType() != CONST_GIMPACT_TRIMESH_SHAPE) {
        return own;
    }
    const auto& mesh = static_cast<const btGImpactMeshShape&>(shape);
    for (int i = 0; i < mesh.getMeshPartCount(); ++i) {
        if (!(mesh.getMeshPart(i)->getMargin() >= 0)) {
            return mesh.getMeshPart(i)->getMargin();
        }
    }
    return own;
}

class MeshFinder {
  public:
    MeshFinder(const Use& use, std::vector<Finding>& findings) : m_use(use), m_findings(findings) {}

    void run() {
        const bool marginIsOne = margin();
        if (!scale()) {
            return;
        }
        MeshReport report;
        try {
            std::vector<PartSource> sources;
            sourcesOf(*m_use.shape, sources);
            const ShapeMesh mesh = readMesh(sources);
            requireUsable(mesh.view());
            report = inspect(mesh.view());
        } catch (const Error& error) {
            add(FindingCode::unusableMesh, Severity::error, 0,
                "The mesh is refused, and nothing collides with it: " + std::string(error.what()) + ".");
            return;
        }
        surface(report);
        size(report);
        if (marginIsOne) {
            thickness(report);
        }
    }

  private:
    bool margin() {
        const btScalar margin = rawMargin(*m_use.shape);
        if (margin >= 0 && std::isfinite(margin)) {
            return true;
        }
        add(FindingCode::badMargin, Severity::error, static_cast<double>(margin),
            "The margin is " + shortNumber(static_cast<double>(margin)) + ": it is taken as 0. Call setMargin.");
        return false;
    }

    bool scale() {
        const btVector3& scaling = m_use.shape->getLocalScaling();
        const btVector3 size = scaling.absolute();
        const btScalar least = size[size.minAxis()];
        const btScalar most = size[size.maxAxis()];
        if (!isFinite(scaling) || !(least > 0)) {
            add(FindingCode::badScale, Severity::error, 0,
                "The local scaling is zero or no number: the mesh is refused, and nothing collides with it.");
            return false;
        }
        if (most > least * btScalar(1.001)) {
            add(FindingCode::nonUniformScale, Severity::note, static_cast<double>(most / least),
                "The scaling differs by " + shortNumber(static_cast<double>(most / least)) +
                    " between the axes. Contacts follow it; the margin does not, and inertia must be computed from "
                    "the scaled shape.");
        }
        return true;
    }

    void surface(const MeshReport& report) {
        if (!report.closed) {
            const std::size_t edges = report.boundaryEdges + report.nonManifoldEdges + report.misorientedEdges;
            add(FindingCode::openMesh, m_use.moves ? Severity::warning : Severity::note, static_cast<double>(edges),
                "The mesh does not close (" + std::to_string(report.boundaryEdges) + " open edges, " +
                    std::to_string(report.nonManifoldEdges) + " shared by three or more, " +
                    std::to_string(report.misorientedEdges) +
                    " turned against their neighbour): it has no inside, and what has passed through it stays on the "
                    "other side.");
        } else if (report.volume < 0) {
            add(FindingCode::insideOut, Severity::warning, report.volume,
                "The mesh is inside out, its volume is " + shortNumber(report.volume) +
                    " m^3: it is taken as a surface without an inside. Swap two corners of every triangle.");
        }
        if (report.degenerateTriangles > 0) {
            add(FindingCode::degenerateTriangles, Severity::note, static_cast<double>(report.degenerateTriangles),
                std::to_string(report.degenerateTriangles) + " of " + std::to_string(report.triangles) +
                    " triangles have no area: they cost time and carry no contacts.");
        }
        if (report.relativePrecision > 0.01) {
            add(FindingCode::imprecise, Severity::warning, report.relativePrecision,
                "So far from the mesh's own origin, rounding is " + shortNumber(100 * report.relativePrecision) +
                    " % of the shortest edge: move the vertices to the origin and the body to where they were.");
        }
    }

    void size(const MeshReport& report) {
        const auto threshold = static_cast<double>(gContactBreakingThreshold);
        const auto half = static_cast<double>((report.upper - report.lower).norm()) / 2;
        if (m_use.moves && half < threshold) {
            add(FindingCode::tiny, Severity::warning, half,
                "Half its diagonal is " + shortNumber(half) + " m, less than the contact breaking threshold of " +
                    shortNumber(threshold) + " m: scale the whole scene (and gravity) up.");
        }
        const auto largest =
            static_cast<double>(std::max(report.lower.cwiseAbs().maxCoeff(), report.upper.cwiseAbs().maxCoeff()));
        if (largest * 0x1p-24 > 0.01 * threshold) {
            add(FindingCode::huge, Severity::warning, largest,
                "Coordinates of " + shortNumber(largest) + " m are rounded to " + shortNumber(largest * 0x1p-24) +
                    " m: cut the mesh into pieces with origins of their own.");
        }
    }

    /// Of a plate its thickness; for an open mesh a tenth of its diagonal stands in.
    void thickness(const MeshReport& report) {
        const bool solid = report.closed && report.volume > 0 && report.area > 0;
        const double thick =
            solid ? 2 * report.volume / report.area : static_cast<double>((report.upper - report.lower).norm()) / 10;
        const auto margin = static_cast<double>(marginOf(*m_use.shape));
        if (2 * margin > thick) {
            add(FindingCode::largeMargin, Severity::warning, margin / thick,
                "The margin of " + shortNumber(margin) + " m is large against " + shortNumber(thick) + " m, " +
                    (solid ? "the mesh's mean thickness" : "a tenth of the mesh's diagonal") +
                    ": holes and grooves close, and bodies keep apart. Call setMargin.");
        }
    }

    void add(FindingCode code, Severity severity, double value, std::string message) {
        m_findings.push_back({code, severity, m_use.body, -1, m_use.shape, value, std::move(message)});
    }

    Use m_use;
    std::vector<Finding>& m_findings;
};

}  // namespace

void diagnoseMeshes(const Patient& patient, std::vector<Finding>& findings) {
    for (const Use& use : usesOf(patient)) {
        MeshFinder(use, findings).run();
    }
}

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
