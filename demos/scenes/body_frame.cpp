// This work is based on:
// Jonathan Blow, Atman Binstock. How to find the inertia tensor of a solid body. 2004 (covariance of tetrahedra)
#include "body_frame.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include <scenes/true_penetration.hpp>

namespace grapeshot::scenes {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

struct Moments {
    double weight = 0;  ///< m^3 or m^2
    Vector3d first = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();
};

/// Integrals of 1, x and x x^T over a simplex whose corners have the given sum and sum of squares.
void add(Moments& moments, double weight, int corners, const Vector3d& sum, const Matrix3d& squares) {
    moments.weight += weight;
    moments.first += weight / corners * sum;
    moments.second += weight / (corners * (corners + 1)) * (squares + sum * sum.transpose());
}

Moments momentsOf(const Mesh& mesh, const Vector3d& origin, bool solid) {
    Moments moments;
    for (const Triangle& t : mesh.triangles) {
        Vector3d p[3];
        Vector3d sum = Vector3d::Zero();
        Matrix3d squares = Matrix3d::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            p[k] = mesh.vertices[t[k]].cast<double>() - origin;
            sum += p[k];
            squares += p[k] * p[k].transpose();
        }
        if (solid) {
            add(moments, p[0].dot(p[1].cross(p[2])) / 6, 4, sum, squares);
        } else {
            add(moments, (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2, 3, sum, squares);
        }
    }
    return moments;
}

}  // namespace

BodyFrame bodyFrame(const Mesh& mesh) {
    BodyFrame frame;
    frame.solid = TrueSurface(mesh.view()).closed();
    // Twice: moments about a point far from the mesh cancel badly.
    for (int pass = 0; pass < 2; ++pass) {
        const Moments about = momentsOf(mesh, frame.centre, frame.solid);
        if (about.weight != 0) {
            frame.centre += about.first / about.weight;
        }
    }
    const Moments moments = momentsOf(mesh, frame.centre, frame.solid);
    if (moments.weight == 0) {
        return frame;
    }
    const Matrix3d covariance = moments.second / moments.weight;
    const Matrix3d inertia = covariance.trace() * Matrix3d::Identity() - covariance;
    frame.unitInertia = inertia.diagonal();
    const double crossed = (inertia - Matrix3d(frame.unitInertia.asDiagonal())).cwiseAbs().maxCoeff();
    // Axes are left alone where they are principal already: equal inertias would turn them at random.
    if (crossed > 1e-5 * inertia.trace()) {
        const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
        frame.axes = solver.eigenvectors();
        if (frame.axes.determinant() < 0) {
            frame.axes.col(0) *= -1;
        }
        frame.unitInertia = solver.eigenvalues();
    }
    return frame;
}

Mesh inBodyFrame(Mesh mesh, const BodyFrame& frame) {
    for (Eigen::Vector3f& v : mesh.vertices) {
        v = (frame.axes.transpose() * (v.cast<double>() - frame.centre)).cast<float>();
    }
    return mesh;
}

}  // namespace grapeshot::scenes
