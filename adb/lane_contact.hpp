// One lane of a distance batch as a contact.
#pragma once

#include <cstdint>

#include <grapeshot/adb/query.hpp>
#include <grapeshot/core/triangle_batch.hpp>

namespace grapeshot {

/// What the kernel says of lane `lane` (0..15), which held `pair`.
[[nodiscard]] inline TriangleContact laneContact(const DistanceBatch& batch, std::uint32_t lane,
                                                 const TrianglePair& pair) {
    TriangleContact contact;
    contact.pair = pair;
    contact.onA = {batch.onA[0][lane], batch.onA[1][lane], batch.onA[2][lane]};
    contact.onB = {batch.onB[0][lane], batch.onB[1][lane], batch.onB[2][lane]};
    contact.signedDistance = batch.signedDistance[lane];
    contact.featureA = static_cast<std::uint8_t>(batch.featureA[lane]);
    contact.featureB = static_cast<std::uint8_t>(batch.featureB[lane]);
    contact.overlapping = (batch.overlapping >> lane & 1U) != 0U;
    return contact;
}

}  // namespace grapeshot
