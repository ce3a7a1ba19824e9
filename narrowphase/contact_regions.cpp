#include <grapeshot/narrowphase/contact_regions.hpp>

#include <algorithm>
#include <cassert>

#include <grapeshot/core/detail/point_grid.hpp>
#include <grapeshot/narrowphase/detail/region_grouping.hpp>

namespace grapeshot {
namespace detail {
namespace {

struct Ranked {
    float signedDistance;
    std::uint32_t contact;
};

bool isUsable(const SurfaceContact& contact) {
    return contact.onA.allFinite() && contact.onB.allFinite() && contact.normal.allFinite() &&
           std::isfinite(contact.signedDistance);
}

/// Order of equally deep contacts: by their place, so that the caller's order does not matter. -1, 0, 1.
int comparePlaces(const SurfaceContact& left, const SurfaceContact& right) {
    const auto sign = [](float a, float b) { return a < b ? -1 : (b < a ? 1 : 0); };
    for (const auto member : {&SurfaceContact::onA, &SurfaceContact::onB, &SurfaceContact::normal}) {
        for (int axis = 0; axis < 3; ++axis) {
            if (const int place = sign((left.*member)[axis], (right.*member)[axis]); place != 0) {
                return place;
            }
        }
    }
    return 0;
}

RegionGroups::Summary summarise(std::span<const SurfaceContact> contacts, std::span<const std::uint32_t> members) {
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const std::uint32_t member : members) {
        const SurfaceContact& contact = contacts[member];
        normal += contact.normal.cast<double>();
        center += 0.5 * (contact.onA.cast<double>() + contact.onB.cast<double>());
    }
    const SurfaceContact& deepest = contacts[members.front()];
    const double length = normal.norm();
    RegionGroups::Summary summary;
    // Only a cone of 90 degrees or more lets the normals cancel.
    summary.normal = length > 1e-6 ? Eigen::Vector3f((normal / length).cast<float>()) : deepest.normal;
    summary.center = (center / static_cast<double>(members.size())).cast<float>();
    summary.depth = -deepest.signedDistance;
    return summary;
}

/// Do both lie on one flat face, of A or of B?
bool inOnePlane(const SurfaceContact& seed, const SurfaceContact& other, float height) {
    return other.normal.dot(seed.normal) >= flatCone && (std::abs((other.onB - seed.onB).dot(seed.normal)) <= height ||
                                                         std::abs((other.onA - seed.onA).dot(seed.normal)) <= height);
}

}  // namespace

void groupRegions(std::span<const SurfaceContact> contacts, const RegionSettings& settings, RegionGroups& out) {
    assert(settings.spacing > 0.0F);
    struct Scratch {
        std::vector<Ranked> order;        // usable contacts, deepest first
        std::vector<std::uint32_t> rank;  // place of each contact in `order`
        std::vector<char> grouped;
        std::vector<std::uint32_t> open;  // members whose neighbours are not known yet
        PointGrid grid;
    };
    thread_local Scratch scratch;
    std::vector<Ranked>& order = scratch.order;
    std::vector<std::uint32_t>& rank = scratch.rank;
    std::vector<char>& grouped = scratch.grouped;
    std::vector<std::uint32_t>& open = scratch.open;
    PointGrid& grid = scratch.grid;

    out.members.clear();
    out.begin.assign(1, 0);
    out.regions.clear();
    order.clear();
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        if (isUsable(contacts[i])) {
            order.push_back({contacts[i].signedDistance, i});
        }
    }
    std::sort(order.begin(), order.end(), [&](const Ranked& left, const Ranked& right) {
        if (left.signedDistance != right.signedDistance) {
            return left.signedDistance < right.signedDistance;
        }
        const int places = comparePlaces(contacts[left.contact], contacts[right.contact]);
        return places != 0 ? places < 0 : left.contact < right.contact;
    });
    rank.resize(contacts.size());
    grouped.assign(contacts.size(), 0);
    grid.reset(contacts.size(), settings.spacing);
    for (std::size_t i = order.size(); i-- > 0;) {
        rank[order[i].contact] = static_cast<std::uint32_t>(i);
        grid.insert(order[i].contact, contacts[order[i].contact].onA);
    }

    const float flat = flatHeight * settings.spacing;
    const float squaredSpacing = settings.spacing * settings.spacing;
    for (const auto& [depth, seed] : order) {
        if (grouped[seed] != 0) {
            continue;
        }
        const Eigen::Vector3f seedNormal = contacts[seed].normal;
        const std::size_t first = out.members.size();
        open.clear();
        const auto join = [&](std::uint32_t contact) {
            grouped[contact] = 1;
            out.members.push_back(contact);
            open.push_back(contact);
        };
        for (const auto& [otherDepth, other] : order) {
            if (other == seed || (grouped[other] == 0 && inOnePlane(contacts[seed], contacts[other], flat))) {
                join(other);
            }
        }
        // The last one found comes first: what is connected does not depend on the order, and a search that gets on
        // quickly empties the grid sooner.
        while (!open.empty() && out.members.size() < order.size()) {
            const SurfaceContact& contact = contacts[open.back()];
            open.pop_back();
            grid.take(contact.onA, [&](std::uint32_t other) {
                if (grouped[other] != 0) {
                    return true;  // joined by another way: left in the grid until somebody comes by
                }
                const SurfaceContact& candidate = contacts[other];
                if ((candidate.onA - contact.onA).squaredNorm() > squaredSpacing ||
                    (candidate.onB - contact.onB).squaredNorm() > squaredSpacing ||
                    candidate.normal.dot(seedNormal) < settings.normalCone) {
                    return false;
                }
                join(other);
                return true;
            });
        }
        std::sort(out.members.begin() + static_cast<std::ptrdiff_t>(first), out.members.end(),
                  [&](std::uint32_t left, std::uint32_t right) { return rank[left] < rank[right]; });
        out.begin.push_back(static_cast<std::uint32_t>(out.members.size()));
        out.regions.push_back(summarise(contacts, std::span(out.members).subspan(first)));
    }
}

}  // namespace detail

std::vector<ContactRegion> groupRegions(std::span<const SurfaceContact> contacts, const RegionSettings& settings) {
    detail::RegionGroups groups;
    detail::groupRegions(contacts, settings, groups);
    std::vector<ContactRegion> regions(groups.regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const auto members = groups.membersOf(r);
        regions[r].members.assign(members.begin(), members.end());
        regions[r].normal = groups.regions[r].normal;
        regions[r].center = groups.regions[r].center;
        regions[r].depth = groups.regions[r].depth;
    }
    return regions;
}

}  // namespace grapeshot
