#include "bullet_scene.hpp"

#include <BulletFileLoader/btBulletFile.h>
#include <LinearMath/btSerializer.h>

#include <fstream>
#include <string>

#include <grapeshot/core/error.hpp>
#include <import/bullet_check.hpp>
#include <import/detail/bullet_importer.hpp>
#include <import/detail/trial.hpp>

namespace grapeshot::import {
namespace {

constexpr std::uintmax_t mostBytes = std::uintmax_t{1} << 30U;

}  // namespace

struct BulletScene::State {
    btDefaultCollisionConfiguration configuration;
    scenes::TimedDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    detail::BulletImporter importer{world};
    scenes::Engine engine = scenes::Engine::none;

    State() { world.getDispatchInfo().m_deterministicOverlappingPairs = true; }
    ~State() { importer.deleteAllData(); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    /// Bullet writes into the bytes.
    void load(std::vector<std::byte> bytes, const std::string& place) {
        if (!importer.loadFileFromMemory(reinterpret_cast<char*>(bytes.data()), static_cast<int>(bytes.size()))) {
            throw Error(Fault::badFile, "Bullet's loader refuses it", place);
        }
    }
};

std::vector<std::byte> readBulletFile(const std::filesystem::path& file) {
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(file, failure);
    if (failure) {
        throw Error(Fault::badFile, failure.message(), file.string());
    }
    if (size > mostBytes) {
        throw Error(Fault::limitExceeded, std::to_string(size) + " bytes", file.string());
    }
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    std::ifstream in(file, std::ios::binary);
    if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
        throw Error(Fault::badFile, "cannot be read", file.string());
    }
    return bytes;
}

BulletScene::BulletScene(const std::filesystem::path& file, scenes::Engine engine, const Settings& settings) {
    const std::vector<std::byte> bytes = readBulletFile(file);
    checkBulletFile(bytes, file.string());
    const std::string end = detail::tryInChild([&] {
        State trial;
        trial.load(bytes, file.string());
    });
    if (!end.empty()) {
        throw Error(Fault::badFile, "Bullet's loader " + end, file.string());
    }
    m_state = std::make_unique<State>();
    m_state->engine = engine;
    scenes::install(engine, m_state->dispatcher, settings);
    m_state->load(bytes, file.string());
    if (engine == scenes::Engine::grapeshot) {
        // As GImpact builds its own: now, and not in the first step. What is no mesh or cannot be used says so, later.
        for (int i = 0; i < m_state->importer.getNumCollisionShapes(); ++i) {
            static_cast<void>(prebuild(m_state->importer.getCollisionShapeByIndex(i)));
        }
    }
}

BulletScene::~BulletScene() = default;

btDiscreteDynamicsWorld& BulletScene::world() {
    return m_state->world;
}

scenes::TimedDispatcher& BulletScene::dispatcher() {
    return m_state->dispatcher;
}

const BulletSceneSummary& BulletScene::summary() const {
    return m_state->importer.summary();
}

void writeBulletFile(btDiscreteDynamicsWorld& world, const std::filesystem::path& file) {
    btDefaultSerializer serializer;
    world.serialize(&serializer);
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(serializer.getBufferPointer()), serializer.getCurrentBufferSize());
    if (!out.flush()) {
        throw Error(Fault::badFile, "cannot be written", file.string());
    }
}

}  // namespace grapeshot::import
