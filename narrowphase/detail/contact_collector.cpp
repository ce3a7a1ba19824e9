#include <grapeshot/narrowphase/detail/contact_collector.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace grapeshot::detail {
namespace {

constexpr std::uint32_t fresh = 0xffffffffU;
constexpr std::uint32_t rejected = 0xfffffffeU;
constexpr float oneDirection = 0.97F;  // cosine: narrower than the normals of any two faces one wants apart

auto rank(const SurfaceContact& contact) {
    return std::tuple(contact.triangleA, contact.triangleB, contact.onA.x(), contact.onA.y(), contact.onA.z());
}

}  // namespace

bool ContactCollector::isNew(const FeaturePairKey& key, std::uint32_t triangleA, std::uint32_t triangleB) {
    std::uint32_t& value = m_seen.at(key, fresh);
    if (value == fresh) {
        value = rejected;
        return true;
    }
    if (value != rejected) {
        for (std::uint32_t i = value; i < m_found.size() && m_found[i].key == key; ++i) {
            SurfaceContact& contact = m_found[i].contact;
            contact.triangleA = std::min(contact.triangleA, triangleA);
            contact.triangleB = std::min(contact.triangleB, triangleB);
        }
    }
    return false;
}

void ContactCollector::add(const FeaturePairKey& key, const SurfaceContact& contact) {
    std::uint32_t& value = m_seen.at(key, rejected);
    if (value == rejected) {
        value = static_cast<std::uint32_t>(m_found.size());
    }
    m_found.push_back({key, contact});
}

void ContactCollector::thinCornersOf(std::uint64_t FeaturePairKey::*side) {
    m_order.clear();
    for (std::uint32_t i = 0; i < m_found.size(); ++i) {
        if (m_found[i].alive && isCorner(m_found[i].key.*side)) {
            m_order.push_back(i);
        }
    }
    std::sort(m_order.begin(), m_order.end(), [&](std::uint32_t i, std::uint32_t j) {
        const Found& l = m_found[i];
        const Found& r = m_found[j];
        const float depthL = std::abs(l.contact.signedDistance);
        const float depthR = std::abs(r.contact.signedDistance);
        return std::tuple(l.key.*side, depthL, l.key, i) < std::tuple(r.key.*side, depthR, r.key, j);
    });
    for (std::size_t begin = 0; begin < m_order.size(); ++begin) {
        const Found& kept = m_found[m_order[begin]];
        for (std::size_t i = begin + 1; kept.alive && i < m_order.size(); ++i) {
            Found& other = m_found[m_order[i]];
            if (other.key.*side != kept.key.*side) {
                break;
            }
            other.alive = other.alive && other.contact.normal.dot(kept.contact.normal) < oneDirection;
        }
    }
}

void ContactCollector::thinCorners() {
    thinCornersOf(&FeaturePairKey::a);
    thinCornersOf(&FeaturePairKey::b);
}

void ContactCollector::thinPlaces(float merge) {
    m_order.clear();
    for (std::uint32_t i = 0; i < m_found.size(); ++i) {
        if (m_found[i].alive) {
            m_order.push_back(i);
        }
    }
    std::sort(m_order.begin(), m_order.end(), [&](std::uint32_t i, std::uint32_t j) {
        const Found& l = m_found[i];
        const Found& r = m_found[j];
        return std::tuple(l.contact.onA.x(), l.key, i) < std::tuple(r.contact.onA.x(), r.key, j);
    });
    const float squared = merge * merge;
    for (std::size_t begin = 0; begin < m_order.size(); ++begin) {
        Found& kept = m_found[m_order[begin]];
        for (std::size_t i = begin + 1; kept.alive && i < m_order.size(); ++i) {
            Found& other = m_found[m_order[i]];
            if (other.contact.onA.x() > kept.contact.onA.x() + merge) {
                break;
            }
            if (other.alive && (other.contact.onA - kept.contact.onA).squaredNorm() <= squared &&
                (other.contact.onB - kept.contact.onB).squaredNorm() <= squared &&
                other.contact.normal.dot(kept.contact.normal) > oneDirection) {
                // Both keys are the same in any order of input; so is the one that stays.
                (kept.key < other.key ? other : kept).alive = false;
            }
        }
    }
}

void ContactCollector::finish(float merge, std::vector<SurfaceContact>& out) {
    thinPlaces(merge);
    std::sort(m_order.begin(), m_order.end(), [&](std::uint32_t i, std::uint32_t j) {
        const Found& l = m_found[i];
        const Found& r = m_found[j];
        return std::tuple(l.key, rank(l.contact)) < std::tuple(r.key, rank(r.contact));
    });
    for (const std::uint32_t i : m_order) {
        if (m_found[i].alive) {
            out.push_back(m_found[i].contact);
        }
    }
}

}  // namespace grapeshot::detail
