// Two surfaces, or one, that deform and touch: small enough for every pair of triangles to be looked at.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <grapeshot/core/bytes.hpp>
#include <grapeshot/scf/tracker.hpp>

#include <scenes/shapes.hpp>

namespace grapeshot::test {

/// A bumpy sphere that waves, and another one that comes and goes along x.
class TwoBumpy {
  public:
    explicit TwoBumpy(int frequency = 10)
        : meshA(scenes::bumpySphere(1, 0.3F, 7, frequency, 3)),
          meshB(scenes::bumpySphere(1, 0.25F, 5, frequency, 4)),
          a(buildBallTree(meshA.view())),
          b(buildBallTree(meshB.view())) {}

    struct Frame {
        std::vector<Eigen::Vector3f> a, b;
        [[nodiscard]] SurfaceState stateA(Stretch stretch = Stretch::measured()) const { return {a, {}, stretch, {}}; }
        [[nodiscard]] SurfaceState stateB(Stretch stretch = Stretch::measured()) const { return {b, {}, stretch, {}}; }
    };
    [[nodiscard]] Frame at(int frame) const { return at(static_cast<float>(frame)); }
    [[nodiscard]] Frame at(float frame) const {
        const float phase = 0.2F * frame;
        Frame result{waved(meshA, phase), waved(meshB, -phase)};
        for (Eigen::Vector3f& vertex : result.b) {
            vertex += Eigen::Vector3f(1.95F + 0.3F * std::cos(0.15F * frame), 0.1F, -0.2F);
        }
        return result;
    }

    [[nodiscard]] static TrackSettings settings(TrackMode mode) {
        TrackSettings result;
        result.mode = mode;
        result.maxDistance = 0.02F;
        result.spacing = 0.1F;
        result.frontCells = 64;
        return result;
    }

    scenes::Mesh meshA, meshB;
    BallTree a, b;

  private:
    static std::vector<Eigen::Vector3f> waved(const scenes::Mesh& mesh, float phase) {
        std::vector<Eigen::Vector3f> moved = mesh.vertices;
        for (Eigen::Vector3f& vertex : moved) {
            vertex[1] += 0.1F * std::sin(3 * vertex[0] + phase);
        }
        return moved;
    }
};

/// A strip, long and flat at rest, rolled up so that its turns touch.
class Roll {
  public:
    Roll() : mesh(scenes::grid(3, 0.3F, 120, 12)), tree(buildBallTree(mesh.view())) {}

    [[nodiscard]] std::vector<Eigen::Vector3f> at(int frame) const { return at(static_cast<float>(frame)); }
    [[nodiscard]] std::vector<Eigen::Vector3f> at(float frame) const {
        std::vector<Eigen::Vector3f> moved;
        const float breath = 1 + 0.2F * std::sin(0.3F * frame);
        for (const Eigen::Vector3f& vertex : mesh.vertices) {
            // An Archimedean spiral, by arc length as far as it matters.
            const float turn = std::sqrt(1 + 8 * (vertex[0] + 3));
            const float radius = 0.05F * turn * (1 + 0.05F * breath * std::sin(3 * turn));
            moved.emplace_back(radius * std::cos(turn), radius * std::sin(turn), vertex[2]);
        }
        return moved;
    }
    [[nodiscard]] static TrackSettings settings(TrackMode mode) {
        TrackSettings result;
        result.mode = mode;
        result.maxDistance = 0.28F;
        result.spacing = 0.2F;
        result.exclusion = 0.5F;
        result.frontCells = 64;
        return result;
    }

    scenes::Mesh mesh;
    BallTree tree;
};

/// Everything that a result says.
inline std::vector<std::byte> bytesOf(const TrackResult& result) {
    std::vector<std::byte> bytes;
    ByteWriter writer(bytes);
    const auto put = [&](const TrackedContact& contact) {
        writer.put(contact.pair.triangleA);
        writer.put(contact.pair.triangleB);
        writer.put(contact.onA);
        writer.put(contact.onB);
        writer.put(contact.normal);
        writer.put(contact.signedDistance);
        writer.put(contact.featureA);
        writer.put(contact.featureB);
        writer.put(contact.overlapping);
        writer.put(contact.time);
        writer.put(contact.age);
    };
    for (const auto* list : {&result.contacts, &result.ahead}) {
        std::for_each(list->begin(), list->end(), put);
    }
    writer.put(result.certain);
    writer.put(result.stop);
    writer.put(result.work);
    writer.put(result.miss.candidates);
    writer.put(result.miss.unknown);
    writer.put(result.miss.sampled);
    writer.put(result.miss.hits);
    writer.put(result.miss.open);
    writer.put(result.miss.missed);
    writer.put(result.miss.missedBound);
    writer.put(result.miss.unseenBound);
    writer.put(result.tracked);
    writer.put(result.dives);
    writer.put(result.nearer);
    writer.put(result.frontKept);
    writer.put(result.frontOpened);
    return bytes;
}

}  // namespace grapeshot::test
