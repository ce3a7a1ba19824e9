// This work is based on:
// Jonathan Blow, Atman Binstock. How to find the inertia tensor of a solid body. 2004 (covariance of tetrahedra)
#include <grapeshot/plugin/mass_properties.hpp>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_report.hpp>
#include <grapeshot/plugin/detail/shape_kind.hpp>
#include <grapeshot/plugin/detail/shape_mesh.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Integrals of 1, x and x x^T.
struct Moments {
    double weight = 0;  // m^3 or m^2
    Vector3d first = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();

    /// Over a simplex with so many corners, whose sum and sum of squares are given.
    void add(double part, int corners, const Vector3d& sum, const Matrix3d& squares) {
        weight += part;
        first += part / corners * sum;
        second += part / (corners * (corners + 1)) * (squares + sum * sum.transpose());
    }
};

Moments momentsAbout(const MeshView& mesh, const Vector3d& origin, bool solid) {
    Moments moments;
    for (const Triangle& triangle : mesh.triangles) {
        std::array<Vector3d, 3> p;
        Vector3d sum = Vector3d::Zero();
        Matrix3d squares = Matrix3d::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = mesh.vertices[triangle[k]].cast<double>() - origin;
            sum += p[k];
            squares += p[k] * p[k].transpose();
        }
        if (solid) {
            // The tetrahedron with the origin, whose own share is zero.
            moments.add(p[0].dot(p[1].cross(p[2])) / 6, 4, sum, squares);
        } else {
            moments.add((p[1] - p[0]).cross(p[2] - p[0]).norm() / 2, 3, sum, squares);
        }
    }
    return moments;
}

btVector3 narrowed(const Vector3d& v) {
    return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

/// `centre`: anywhere near.
void fill(const MeshView& mesh, Vector3d centre, double mass, MassProperties& result) {
    // Twice: moments about a point far from the mesh cancel badly.
    const Moments rough = momentsAbout(mesh, centre, result.solid);
    centre += rough.first / rough.weight;
    const Moments moments = momentsAbout(mesh, centre, result.solid);
    result.volume = btScalar(result.solid ? moments.weight : 0);
    result.area = btScalar(momentsAbout(mesh, centre, false).weight);

    const Matrix3d covariance = moments.second / moments.weight;
    const Matrix3d inertia = mass * (covariance.trace() * Matrix3d::Identity() - covariance);
    Matrix3d axes = Matrix3d::Identity();
    Vector3d diagonal = inertia.diagonal();
    const double mixed = (inertia - Matrix3d(diagonal.asDiagonal())).cwiseAbs().maxCoeff();
    // Equal inertias (a cube's) would turn the axes at random.
    if (mixed > 1e-6 * inertia.trace()) {
        const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
        axes = solver.eigenvectors();
        if (axes.determinant() < 0) {
            axes.col(0) *= -1;
        }
        diagonal = solver.eigenvalues();
    }
    for (int row = 0; row < 3; ++row) {
        result.principal.getBasis()[row] = narrowed(axes.row(row).transpose());
    }
    result.principal.setOrigin(narrowed(centre));
    result.inertia = narrowed(diagonal);
}

}  // namespace

MassProperties massProperties(const btCollisionShape* shape, btScalar mass, MassModel model) noexcept {
    MassProperties result;
    const auto failed = [](Status status) {
        MassProperties none;
        none.status = status;
        return none;
    };
    if (shape == nullptr) {
        return failed(Status::nullPointer);
    }
    if (!detail::isMesh(*shape)) {
        return failed(Status::unsupportedShape);
    }
    if (!(mass > 0) || !std::isfinite(mass)) {
        return failed(Status::badArgument);
    }
    try {
        std::vector<detail::PartSource> sources;
        detail::sourcesOf(*shape, sources);
        const detail::ShapeMesh mesh = detail::readMesh(sources);
        requireUsable(mesh.view());
        const MeshReport report = inspect(mesh.view());
        const bool hasInside = report.closed && report.volume > 0;
        if (model == MassModel::solid && !hasInside) {
            return failed(Status::badArgument);
        }
        result.solid = hasInside && model != MassModel::shell;
        const Vector3d middle = ((report.lower + report.upper) / 2).cast<double>();
        fill(mesh.view(), middle, static_cast<double>(mass), result);
        return result;
    } catch (const Error&) {
        return failed(Status::unusableMesh);
    } catch (...) {
        return failed(Status::outOfMemory);
    }
}

}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
