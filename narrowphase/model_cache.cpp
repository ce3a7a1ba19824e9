#include <grapeshot/narrowphase/model_cache.hpp>

#include <algorithm>
#include <cinttypes>
#include <compare>
#include <cstdio>
#include <future>
#include <list>
#include <map>
#include <mutex>

#include <grapeshot/adb/tree_builder.hpp>
#include <grapeshot/adb/tree_file.hpp>
#include <grapeshot/core/error.hpp>
#include <grapeshot/core/mesh_slices.hpp>
#include <grapeshot/narrowphase/model_builder.hpp>

namespace grapeshot {
namespace {

using Model = std::shared_ptr<const MeshModel>;

struct CacheKey {
    std::uint64_t low, high;
    int maxLeafTriangles, bins, tuningPoses;
    bool features;
    friend auto operator<=>(const CacheKey&, const CacheKey&) = default;
};

std::string fileName(const ContentKey& key, const BuildSettings& settings) {
    char name[80];
    std::snprintf(name, sizeof(name), "%016" PRIx64 "%016" PRIx64 "-%d-%d-%d.tree", key.high, key.low,
                  settings.maxLeafTriangles, settings.bins, settings.tuningPoses);
    return name;
}

}  // namespace

struct ModelCache::State {
    State(std::size_t idleModels, std::filesystem::path where) : idle(idleModels), folder(std::move(where)) {}

    const std::size_t idle;
    mutable std::mutex mutex;
    std::filesystem::path folder;  // empty: none
    std::map<CacheKey, std::weak_ptr<const MeshModel>> models;
    std::map<CacheKey, std::shared_future<Model>> building;
    std::list<Model> recent;  // latest first, at most `idle`
    std::uint64_t hits = 0, builds = 0, loads = 0, badFiles = 0;
    std::string warning;

    /// Under the lock. What leaves the list goes to `leaving`, to be freed after the lock.
    void touch(const Model& model, std::list<Model>& leaving) {
        const auto place = std::find(recent.begin(), recent.end(), model);
        if (place != recent.end()) {
            recent.splice(recent.begin(), recent, place);
        } else {
            recent.push_front(model);
        }
        while (recent.size() > idle) {
            leaving.splice(leaving.begin(), recent, std::prev(recent.end()));
        }
    }

    /// Where the tree of this content belongs; empty: nowhere.
    std::filesystem::path fileOf(const ContentKey& content, const BuildSettings& settings) {
        const std::lock_guard lock(mutex);
        return folder.empty() ? folder : folder / fileName(content, settings);
    }

    /// False if there is no good file.
    bool load(const std::filesystem::path& file, MeshView mesh, const BuildSettings& settings, Tree& tree) {
        std::error_code ignored;
        if (file.empty() || !std::filesystem::exists(file, ignored)) {
            return false;
        }
        try {
            tree = loadTree(file, mesh, settings);
            const std::lock_guard lock(mutex);
            ++loads;
            return true;
        } catch (const Error& error) {
            warn(error.what());
            return false;
        }
    }

    void save(const Tree& tree, const BuildSettings& settings, const std::filesystem::path& file) {
        if (file.empty()) {
            return;
        }
        try {
            std::error_code ignored;
            std::filesystem::create_directories(file.parent_path(), ignored);
            saveTree(tree, settings, file);
        } catch (const Error& error) {
            warn(error.what());
        }
    }

    /// Its tree from the folder, if it is there.
    Sliced make(MeshView mesh, BuildSettings settings, bool features, ContentKey content, Model& model) {
        auto built = std::make_shared<MeshModel>();
        const std::filesystem::path file = fileOf(content, settings);
        co_yield 1;
        if (!load(file, mesh, settings, built->tree)) {
            co_await buildInSlices(mesh, settings, built->tree);
            co_yield 1;
            save(built->tree, settings, file);
        }
        co_await makeModelInSlices(*built);
        if (features) {
            co_await addFeaturesInSlices(*built);
        }
        const std::lock_guard lock(mutex);
        ++builds;
        model = std::move(built);
    }

    /// Of this key, if it is there.
    Model find(const CacheKey& key) {
        const std::lock_guard lock(mutex);
        const auto found = models.find(key);
        return found != models.end() ? found->second.lock() : nullptr;
    }

    /// Under the lock.
    void publish(const CacheKey& key, const Model& model, std::list<Model>& leaving) {
        std::erase_if(models, [](const auto& entry) { return entry.second.expired(); });
        models[key] = model;
        touch(model, leaving);
    }

    void warn(const std::string& what) {
        const std::lock_guard lock(mutex);
        ++badFiles;
        warning = what;
    }
};

ModelCache::ModelCache(std::size_t idle, std::filesystem::path folder)
    : m_state(std::make_unique<State>(idle, std::move(folder))) {}
ModelCache::~ModelCache() = default;

std::shared_ptr<const MeshModel> ModelCache::get(MeshView mesh, const BuildSettings& settings, bool features) {
    const ContentKey content = contentKey(mesh);
    const CacheKey key{content.low,   content.high,         settings.maxLeafTriangles,
                       settings.bins, settings.tuningPoses, features};
    State& state = *m_state;
    std::list<Model> leaving;  // before the lock, so that it is destroyed after it
    std::promise<Model> promise;
    {
        std::unique_lock lock(state.mutex);
        Model known;
        if (const auto found = state.models.find(key); found != state.models.end()) {
            known = found->second.lock();
        }
        if (!known) {
            if (const auto running = state.building.find(key); running != state.building.end()) {
                const std::shared_future<Model> other = running->second;
                lock.unlock();
                known = other.get();  // the other thread's error is this one's too
                lock.lock();
            }
        }
        if (known) {
            if (!sameContent(known->tree.mesh(), mesh)) {  // equal hashes, other mesh: its model is not shared
                lock.unlock();
                state.make(mesh, settings, features, content, known).run();
                return known;
            }
            ++state.hits;
            state.touch(known, leaving);
            return known;
        }
        state.building.emplace(key, promise.get_future().share());
    }
    try {
        Model model;
        state.make(mesh, settings, features, content, model).run();
        {
            const std::lock_guard lock(state.mutex);
            state.building.erase(key);
            state.publish(key, model, leaving);
        }
        promise.set_value(model);
        return model;
    } catch (...) {
        {
            const std::lock_guard lock(state.mutex);
            state.building.erase(key);
        }
        promise.set_exception(std::current_exception());
        throw;
    }
}

Sliced ModelCache::getInSlices(MeshView mesh, BuildSettings settings, std::shared_ptr<const MeshModel>& model,
                               bool features) {
    State& state = *m_state;
    ContentKey content;
    co_await contentKeyInSlices(mesh, content);
    const CacheKey key{content.low,   content.high,         settings.maxLeafTriangles,
                       settings.bins, settings.tuningPoses, features};
    bool isOther = false;  // equal hashes, other mesh: its model is not shared
    if (const Model known = state.find(key)) {
        bool same = false;
        co_await sameContentInSlices(known->tree.mesh(), mesh, same);
        isOther = !same;
        if (same) {
            std::list<Model> leaving;
            const std::lock_guard lock(state.mutex);
            ++state.hits;
            state.touch(known, leaving);
            model = known;
            co_return;
        }
    }
    Model made;
    co_await state.make(mesh, settings, features, content, made);
    std::list<Model> leaving;
    const std::lock_guard lock(state.mutex);
    if (!isOther) {
        state.publish(key, made, leaving);
    }
    model = std::move(made);
}

void ModelCache::setFolder(std::filesystem::path folder) {
    const std::lock_guard lock(m_state->mutex);
    m_state->folder = std::move(folder);
}

ModelCache::Counts ModelCache::counts() const {
    const std::lock_guard lock(m_state->mutex);
    Counts counts{m_state->hits, m_state->builds, m_state->loads, m_state->badFiles, 0};
    for (const auto& entry : m_state->models) {
        counts.held += entry.second.expired() ? 0U : 1U;
    }
    return counts;
}

std::string ModelCache::lastWarning() const {
    const std::lock_guard lock(m_state->mutex);
    return m_state->warning;
}

void ModelCache::clear() {
    std::list<Model> leaving;
    const std::lock_guard lock(m_state->mutex);
    leaving.swap(m_state->recent);
}

}  // namespace grapeshot
