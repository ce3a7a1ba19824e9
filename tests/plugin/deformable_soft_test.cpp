// Soft bodies against each other and themselves in btDeformableMultiBodyDynamicsWorld.
#include <gmock/gmock.h>

#include <algorithm>

#include "deformable_fixture.hpp"
#include "folded_cloth.hpp"
#include "support/test_size.hpp"

namespace grapeshot::test {
namespace {

using Flags = btSoftBody::fCollision;
constexpr int ours = meetsRigid | Flags::VF_SS | Flags::VF_DD;

/// A sheet that is held at its corners, and one that falls on it.
struct DeformableSheets {
    explicit DeformableSheets(int flags, bool heldFirst = true) {
        btSoftBodyWorldInfo& info = world.world.getWorldInfo();
        const auto addHeld = [&] { held = &world.add(cloth(info, {0, 0, 0}, 1, 15, 15, 1), 0.02_s, flags); };
        if (heldFirst) {
            addHeld();
        }
        falling = &world.add(cloth(info, {0.1_s, 0.3_s, 0.05_s}, 0.5_s, 11, 0, 0.3_s), 0.02_s, flags);
        if (!heldFirst) {
            addHeld();
        }
    }
    /// Nodes below the held sheet, which sags by a metre and more.
    [[nodiscard]] int fallenThrough() const {
        int below = 0;
        for (int i = 0; i < falling->m_nodes.size(); ++i) {
            below += facesAbove(*held, falling->m_nodes[i].m_x) % 2;
        }
        return below;
    }
    [[nodiscard]] int contacts() const { return held->m_faceNodeContacts.size() + falling->m_faceNodeContacts.size(); }
    DeformableTestWorld world;
    btSoftBody* held = nullptr;
    btSoftBody* falling = nullptr;
};

TEST(DeformableSoft, OneSheetRestsOnAnother) {
    for (const bool heldFirst : {true, false}) {
        DeformableSheets sheets(ours, heldFirst);
        sheets.world.step(sampleSize(200, 2400));
        EXPECT_TRUE(isFinite(*sheets.falling) && isFinite(*sheets.held));
        EXPECT_EQ(sheets.fallenThrough(), 0) << heldFirst;
        EXPECT_GT(sheets.contacts(), 5) << heldFirst;
        // Bullet has added nothing to ours.
        EXPECT_EQ(sheets.world.stats().contacts, sheets.contacts()) << heldFirst;
        EXPECT_LT(sheets.world.stats().deepest, 0.04F) << heldFirst;  // both margins: nothing has passed
        EXPECT_EQ(sheets.held->m_scontacts.size() + sheets.falling->m_scontacts.size(), 0);
    }
}

TEST(DeformableSoft, WithoutFlagsTheyDoNotMeet) {
    DeformableSheets sheets(meetsRigid);
    sheets.world.step(240);
    EXPECT_GT(sheets.fallenThrough(), 60);
    EXPECT_EQ(sheets.contacts(), 0);
}

TEST(DeformableSoft, BulletsOwnFlagLeavesThemToBullet) {
    DeformableSheets sheets(meetsRigid | Flags::VF_DD);
    sheets.world.step(120);
    EXPECT_GT(sheets.contacts(), 0);
    EXPECT_EQ(sheets.world.stats().contacts, 0);
}

TEST(DeformableSoft, ContactsOfAnotherWorldDoNotGather) {
    DeformableSheets sheets(meetsRigid | Flags::VF_SS);
    sheets.world.step(200);
    const auto bullets = [&] { return sheets.held->m_scontacts.size() + sheets.falling->m_scontacts.size(); };
    const int ofAStep = bullets();
    EXPECT_GT(ofAStep, 0);
    sheets.world.step(20);
    EXPECT_GT(sheets.contacts(), 0);
    EXPECT_LT(bullets(), 10 * ofAStep);
}

TEST(DeformableSoft, WhatSleepsGathersNoContacts) {
    DeformableSheets sheets(ours);
    sheets.world.step(200);
    sheets.held->forceActivationState(DISABLE_SIMULATION);
    sheets.world.step(20);
    EXPECT_LE(sheets.held->m_faceNodeContacts.size(), sheets.world.stats().contacts);
}

TEST(DeformableSoft, ABodyMayLeaveTheWorldAndOthersGoOn) {
    DeformableSheets sheets(ours);
    sheets.world.step(200);
    EXPECT_GT(sheets.contacts(), 0);
    sheets.world.remove(*sheets.held);
    sheets.world.step(60);
    EXPECT_TRUE(isFinite(*sheets.falling));
    EXPECT_EQ(sheets.falling->m_faceNodeContacts.size(), 0);
    EXPECT_THAT(contactsOf(&sheets.world.dispatcher, sheets.falling), testing::IsEmpty());
}

int belowInDeformableWorld(bool itself) {
    DeformableBudgetWorld world;
    btBoxShape ground({5, 0.5_s, 5});
    world.add(ground, at({0, -0.5_s, 0})).setFriction(1);
    btSoftBody& body = world.add(foldedCloth(world.world.getWorldInfo()), 0.02_s, meetsRigid);
    if (itself) {
        EXPECT_EQ(addSelfCollision(&world.dispatcher, &body), Status::ok);
    }
    world.step(sampleSize(160, 2400));
    EXPECT_TRUE(isFinite(body));
    if (itself) {
        EXPECT_GT(body.m_faceNodeContacts.size(), 0);
        EXPECT_THAT(contactsOf(&world.dispatcher, &body), testing::Not(testing::IsEmpty()));
        EXPECT_EQ(removeSelfCollision(&world.dispatcher, &body), Status::ok);
    }
    return nodesBelowOwnSheet(body);
}

TEST(DeformableSoft, FoldedClothStaysAboveItself) {
    EXPECT_LE(belowInDeformableWorld(true), 1);
    EXPECT_GT(belowInDeformableWorld(false), 10);  // so that the scene is one
}

}  // namespace
}  // namespace grapeshot::test
