// .bullet files: what is in them comes back, and what cannot be is refused before Bullet sees it.
#include <import/bullet_check.hpp>
#include <import/bullet_scene.hpp>
#include <import/detail/bullet_layout.hpp>
#include <import/detail/trial.hpp>

#include <gmock/gmock.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <unistd.h>

#include <grapeshot/core/error.hpp>
#include <scenes/named_scenes.hpp>

namespace grapeshot::test {
namespace {

using import::checkBulletFile;
using import::detail::BulletChunk;
using import::detail::BulletLayout;
using testing::HasSubstr;

struct BulletFile : testing::Test {
    std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("bullet_file_test." + std::to_string(::getpid()));
    std::filesystem::path file = folder / "scene.bullet";
    std::vector<std::byte> bytes;

    BulletFile() {
        std::filesystem::create_directories(folder);
        scenes::World world;
        scenes::findScene("tori")->fill(world);
        world.body(1).setLinearVelocity({1, 2, 3});
        import::writeBulletFile(world.dynamics(), file);
        bytes = import::readBulletFile(file);
    }
    ~BulletFile() override { std::filesystem::remove_all(folder); }

    std::string whatIsWrong(Fault fault = Fault::badFile) {
        try {
            checkBulletFile(bytes, "here");
        } catch (const Error& error) {
            EXPECT_EQ(error.fault(), fault) << error.what();
            return error.what();
        }
        return "";
    }

    /// Where the field of the first structure of that type stands, in a chunk of its own.
    std::size_t find(const std::string& type, const std::string& field) {
        const BulletLayout layout(bytes, "here");
        for (const BulletChunk& chunk : layout.chunks()) {
            if (chunk.type != nullptr && chunk.type->type == type && chunk.number > 0) {
                const auto* found = chunk.type->find(field);
                EXPECT_NE(found, nullptr) << field;
                return layout.offsetOf(chunk.data) + found->offset;
            }
        }
        ADD_FAILURE() << "no " << type;
        return 0;
    }
    template <class Number>
    void set(std::size_t at, Number number) {
        std::memcpy(bytes.data() + at, &number, sizeof number);
    }
};

TEST_F(BulletFile, AnIntactFileIsNotRefused) {
    EXPECT_EQ(whatIsWrong(), "");
    for (const scenes::NamedScene& scene : scenes::namedScenes()) {
        scenes::World world;
        scene.fill(world);
        import::writeBulletFile(world.dynamics(), file);
        bytes = import::readBulletFile(file);
        EXPECT_EQ(whatIsWrong(), "") << scene.name;
    }
}

TEST_F(BulletFile, GImpactBodiesComeBackAsTheyWere) {
    scenes::World world;
    scenes::findScene("tori")->fill(world);
    world.body(1).setLinearVelocity({1, 2, 3});
    import::BulletScene loaded(file, scenes::Engine::grapeshot);
    const import::BulletSceneSummary& summary = loaded.summary();
    EXPECT_EQ(summary.bodies, 3);
    EXPECT_EQ(summary.moving, 2);
    EXPECT_EQ(summary.gimpactShapes, 1);
    EXPECT_EQ(summary.droppedBodies, 0);
    const btCollisionObjectArray& objects = loaded.world().getCollisionObjectArray();
    ASSERT_EQ(objects.size(), 3);
    for (int i = 0; i < 3; ++i) {
        const btRigidBody& was = world.body(static_cast<std::size_t>(i));
        const btRigidBody* is = btRigidBody::upcast(objects[i]);
        ASSERT_NE(is, nullptr);
        EXPECT_EQ(is->getWorldTransform(), was.getWorldTransform());
        EXPECT_EQ(is->getLinearVelocity(), was.getLinearVelocity());
        EXPECT_NEAR(is->getInvMass(), was.getInvMass(), 1e-6);
        EXPECT_LT((is->getInvInertiaDiagLocal() - was.getInvInertiaDiagLocal()).length(), 1e-4);
        EXPECT_EQ(is->getCollisionShape()->getShapeType(), was.getCollisionShape()->getShapeType());
        btVector3 lower, upper, wasLower, wasUpper;
        is->getAabb(lower, upper);
        was.getAabb(wasLower, wasUpper);
        EXPECT_LT((lower - wasLower).length() + (upper - wasUpper).length(), 1e-3);
    }
    EXPECT_EQ(loaded.world().getGravity(), btVector3(0, -9.81F, 0));
    for (int i = 0; i < 120; ++i) {
        loaded.world().stepSimulation(1.0F / 60, 0);
    }
    EXPECT_GT(loaded.dispatcher().getNumManifolds(), 0);
    EXPECT_GT(objects[1]->getWorldTransform().getOrigin().y(), 0);
}

TEST_F(BulletFile, BytesThatEndAreRefusedWherever) {
    const std::vector<std::byte> whole = bytes;
    for (std::size_t size = 0; size < whole.size(); size += size < 200 ? 1 : 509) {
        bytes.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_NE(whatIsWrong(), "") << size;
    }
}

TEST_F(BulletFile, WildCountsAreRefused) {
    for (const int count : {-1, 1 << 20, 0x7fffffff}) {
        const std::vector<std::byte> whole = bytes;
        set(find("btMeshPartData", "m_numTriangles"), count);
        EXPECT_THAT(whatIsWrong(), HasSubstr("m_numTriangles is " + std::to_string(count)));
        bytes = whole;
        set(find("btMeshPartData", "m_numVertices"), count);
        EXPECT_THAT(whatIsWrong(), HasSubstr("m_numVertices is " + std::to_string(count)));
        bytes = whole;
    }
    set(find("btMeshPartData", "m_numVertices"), 3);
    EXPECT_THAT(whatIsWrong(Fault::indexOutOfRange), HasSubstr(" of 3"));
}

TEST_F(BulletFile, WildPointersAreRefused) {
    const std::vector<std::byte> whole = bytes;
    set(find("btMeshPartData", "m_indices32"), std::uint64_t{0x1234567});
    EXPECT_THAT(whatIsWrong(), HasSubstr("m_indices32 points nowhere"));
    bytes = whole;
    set(find("btRigidBodyFloatData", "m_collisionObjectData") +
            BulletLayout(bytes, "").structure("btCollisionObjectFloatData")->find("m_collisionShape")->offset,
        std::uint64_t{77});
    EXPECT_THAT(whatIsWrong(), HasSubstr("m_collisionShape names no shape"));
}

TEST_F(BulletFile, AShapeThatIsAnotherIsRefused) {
    const std::size_t at = find("btGImpactMeshShapeData", "m_collisionShapeData") +
                           BulletLayout(bytes, "").structure("btCollisionShapeData")->find("m_shapeType")->offset;
    for (const int type : {0, 21, 31}) {
        set(at, type);
        EXPECT_THAT(whatIsWrong(), HasSubstr("a shape of type " + std::to_string(type)));
    }
}

TEST_F(BulletFile, ErrorsOfTheSceneHaveNames) {
    EXPECT_THROW(import::BulletScene(folder / "missing.bullet", scenes::Engine::none), Error);
    std::ofstream(file, std::ios::binary | std::ios::trunc) << "nothing";
    EXPECT_THROW(import::BulletScene(file, scenes::Engine::none), Error);
    scenes::World world;
    EXPECT_THROW(import::writeBulletFile(world.dynamics(), "/nonexistent/scene.bullet"), Error);
}

TEST(Trial, WhateverHappensInAChildIsTold) {
    using import::detail::tryInChild;
    EXPECT_EQ(tryInChild([] {}), "");
    EXPECT_EQ(tryInChild([] { throw 1; }), "failed");
    EXPECT_THAT(tryInChild([] { std::raise(SIGSEGV); }), HasSubstr("crashed"));
    EXPECT_EQ(tryInChild([] { std::raise(SIGKILL); }), "ran out of time or memory");
}

}  // namespace
}  // namespace grapeshot::test
