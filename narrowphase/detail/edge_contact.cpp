#include <grapeshot/narrowphase/detail/edge_contact.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace grapeshot::detail {
namespace {

using Eigen::Vector3f;

constexpr float parallelFaces = 0.9998F;  // cosine of 0.02 rad
constexpr float parallelEdges = 1e-3F;    // sine below which a cross product is too inexact for a normal
constexpr float leastCrossing = 1e-5F;    // sine below which a crossing point says nothing
constexpr float exactLean = 1e-3F;
constexpr float overrun = 1e-5F;  // how far beyond its ends an edge counts, in its length

/// Do B's faces and A's agree with `normal` (on B pointing to A), where they have a say?
bool facesRightWay(const SurfaceEdge& a, const SurfaceEdge& b, const Vector3f& normal) {
    return (!b.solid || normal.dot(b.own + b.across) > 0) && (!a.solid || normal.dot(a.own + a.across) < 0);
}

bool extremal(const SurfaceEdge& edge, const Vector3f& along, const Vector3f& towards, float lean) {
    const Vector3f side = along.cross(towards);
    const float limit = lean * along.norm();
    return edge.own.dot(side) <= limit && -edge.across.dot(side) <= limit;
}

/// The common normal of the most parallel pair of faces, on B pointing to A where solids say so; zero if none is nearly
/// parallel. The mean of both, so that A and B can be exchanged.
Vector3f parallelFaceNormal(const SurfaceEdge& a, const SurfaceEdge& b) {
    const bool bothSolid = a.solid && b.solid;
    float best = parallelFaces;
    Vector3f normal = Vector3f::Zero();
    for (const Vector3f* faceB : {&b.own, &b.across}) {
        for (const Vector3f* faceA : {&a.own, &a.across}) {
            const float facing = -faceA->dot(*faceB);
            if (facing > best || (!bothSolid && -facing > best)) {
                best = std::abs(facing);
                const Vector3f fromA = facing > 0 ? Vector3f(-*faceA) : *faceA;
                normal = (*faceB + fromA).normalized();
                if (a.solid && !b.solid && faceA->dot(normal) > 0) {
                    normal = -normal;
                }
            }
        }
    }
    return normal;
}

EdgeContacts alongParallel(const SurfaceEdge& a, const SurfaceEdge& b, float rounding) {
    EdgeContacts out;
    const Vector3f u = a.to - a.from;
    const Vector3f v = b.to - b.from;
    const float length = u.squaredNorm();
    const float first = (b.from - a.from).dot(u) / length;
    const float last = (b.to - a.from).dot(u) / length;
    const float low = std::max(0.0F, std::min(first, last));
    const float high = std::min(1.0F, std::max(first, last));
    if (high < low) {
        return out;
    }
    for (const float t : {low, high}) {
        const Vector3f onA = a.from + t * u;
        const float along = std::clamp((onA - b.from).dot(v) / v.squaredNorm(), 0.0F, 1.0F);
        const Vector3f onB = b.from + along * v;
        const float distance = (onA - onB).norm();
        if (distance < 8 * rounding) {
            continue;  // corners on faces tell what happens here
        }
        const float lean = std::min(0.1F, exactLean + rounding / distance);
        Vector3f normal = (onA - onB) / distance;
        float sign = 1;
        if (!facesRightWay(a, b, normal)) {
            normal = -normal;
            sign = -1;
            if (!(a.solid && b.solid) || !facesRightWay(a, b, normal)) {
                continue;
            }
        }
        if (!extremal(a, u, -normal, lean) || !extremal(b, v, normal, lean)) {
            continue;
        }
        SurfaceContact& contact = out.contact[out.count++];
        contact.onA = onA;
        contact.onB = onB;
        contact.normal = normal;
        contact.signedDistance = sign * distance;
        if (high == low) {
            break;
        }
    }
    return out;
}

}  // namespace

EdgeContacts edgeContacts(const SurfaceEdge& a, const SurfaceEdge& b, float lean, float rounding) {
    const Vector3f u = a.to - a.from;
    const Vector3f v = b.to - b.from;
    const Vector3f cross = u.cross(v);
    const float lengths = std::sqrt(u.squaredNorm() * v.squaredNorm());
    const float area = cross.norm();
    if (!(lengths > 0)) {
        return {};
    }
    const bool bothSharp = a.sharp && b.sharp;
    Vector3f normal = bothSharp ? parallelFaceNormal(a, b) : Vector3f(Vector3f::Zero());
    const bool flat = !normal.isZero();
    if (!flat) {
        if (area < parallelEdges * lengths) {
            return alongParallel(a, b, rounding);
        }
        normal = cross / area;
        const bool flip = b.solid   ? normal.dot(b.own + b.across) < 0
                          : a.solid ? normal.dot(a.own + a.across) > 0
                                    : false;
        if (flip) {
            normal = -normal;
        }
    }
    if (!facesRightWay(a, b, normal)) {
        return {};
    }
    const float crossing = cross.dot(normal);
    if (std::abs(crossing) < leastCrossing * lengths) {
        return {};
    }
    const Vector3f offset = b.from - a.from;
    const float alongA = offset.cross(v).dot(normal) / crossing;
    const float alongB = offset.cross(u).dot(normal) / crossing;
    if (!(alongA >= -overrun && alongA <= 1 + overrun && alongB >= -overrun && alongB <= 1 + overrun)) {
        return {};
    }
    EdgeContacts out;
    SurfaceContact& contact = out.contact[0];
    contact.onA = a.from + alongA * u;
    contact.onB = b.from + alongB * v;
    contact.signedDistance = (contact.onA - contact.onB).dot(normal);
    if (!a.solid && !b.solid && contact.signedDistance < 0) {
        contact.signedDistance = -contact.signedDistance;
        normal = -normal;
    }
    contact.normal = normal;
    const float allowed = bothSharp ? lean : exactLean + rounding / (std::abs(contact.signedDistance) + rounding);
    if (!extremal(a, u, -normal, std::min(allowed, 0.1F)) || !extremal(b, v, normal, std::min(allowed, 0.1F))) {
        return {};
    }
    if (contact.signedDistance < 0 && !(a.solid && b.solid)) {
        return {};
    }
    out.count = 1;
    return out;
}

}  // namespace grapeshot::detail
