// LD_PRELOAD: programs that nobody compiles anew. The loader finds these names before Bullet's, so every collision
// dispatcher that is made passes by here, and so does who registers GImpact on it. Knows nothing of Bullet's types: the
// names are the same in both precisions, and the part that does is loaded when it is clear which one the program has.
#include <dlfcn.h>
#include <link.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <string_view>

#include <grapeshot/plugin/preload/log_line.hpp>
#include <grapeshot/plugin/preload/take_over.hpp>

namespace {

using grapeshot::preload::logLine;

constexpr std::string_view ownVersion = "3.24";  // of Bullet: others have other layouts
constexpr std::string_view libraryName = "libBulletCollision";

std::string fileOf(const void* address) {
    Dl_info info{};
    return dladdr(address, &info) != 0 && info.dli_fname != nullptr ? info.dli_fname : "";
}

/// Bullet's own definition of a name that is also defined here. A library that was opened with its names kept to itself
/// is not among those that come next.
void* bulletsOwn(const char* name) {
    if (void* next = dlsym(RTLD_NEXT, name)) {
        return next;
    }
    struct Search {
        const char* name;
        void* found;
    } search{name, nullptr};
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void* data) {
            auto& wanted = *static_cast<Search*>(data);
            if (std::string_view(info->dlpi_name).find(libraryName) == std::string_view::npos) {
                return 0;
            }
            // Stays loaded: what is found is kept, and the program may close and open its plugin again.
            void* library = dlopen(info->dlpi_name, RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
            void* own = library != nullptr ? dlsym(library, wanted.name) : nullptr;
            if (own != nullptr) {
                if (wanted.found != nullptr && own != wanted.found) {
                    logLine("two Bullets are loaded, and it can't be told whose " + std::string(wanted.name) +
                            " is called");
                    std::abort();
                }
                wanted.found = own;
            }
            return 0;
        },
        &search);
    return search.found;
}

void* demand(const char* name) {
    void* own = bulletsOwn(name);
    if (own == nullptr) {
        logLine(std::string(name) + " is called, but no Bullet is loaded that has it");
        std::abort();  // there is nothing to go on with: a constructor would leave an object unmade
    }
    return own;
}

/// The part that knows Bullet, in the precision of the Bullet that defines a dispatcher's constructor. Null if that is
/// another version, or the part is not there; said once.
class Partner {
  public:
    explicit Partner(const void* constructor) {
        const std::string bullet = fileOf(constructor);
        const std::string_view file = std::string_view(bullet).substr(bullet.rfind('/') + 1);
        if (file.find(libraryName) == std::string_view::npos || file.find(ownVersion) == std::string_view::npos) {
            logLine("Bullet is in " + bullet + ", not in a " + std::string(libraryName) + " of version " +
                    std::string(ownVersion) + ": nothing is taken over");
            return;
        }
        const bool isDouble = file.find("-float64") != std::string_view::npos;
        const std::string own = fileOf(reinterpret_cast<const void*>(&fileOf));
        const std::string partner =
            own.substr(0, own.rfind('/') + 1) + "libgrapeshot-preload-bullet" + (isDouble ? "-float64.so" : ".so");
        void* library = dlopen(partner.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr) {
            const char* why = dlerror();
            logLine(std::string(why != nullptr ? why : partner.c_str()) + ": nothing is taken over");
            return;
        }
        takeOver = reinterpret_cast<GrapeshotTakeOver*>(dlsym(library, grapeshot::preload::takeOverName));
        letGo = reinterpret_cast<GrapeshotLetGo*>(dlsym(library, grapeshot::preload::letGoName));
    }

    GrapeshotTakeOver* takeOver = nullptr;
    GrapeshotLetGo* letGo = nullptr;
};

/// Never destroyed: dispatchers may outlive everything that is static here.
Partner*& partner() {
    static Partner* one = nullptr;
    return one;
}

void takeOver(btCollisionDispatcher* dispatcher, const void* constructor) {
    static Partner* const made = partner() = new Partner(constructor);
    if (made->takeOver != nullptr) {
        made->takeOver(dispatcher);
    }
}

void letGo(btCollisionDispatcher* dispatcher) {
    if (partner() != nullptr && partner()->letGo != nullptr) {
        partner()->letGo(dispatcher);
    }
}

struct AtTheEnd {
    ~AtTheEnd() {
        const char* process = std::getenv(grapeshot::preload::processVariable);
        if (partner() == nullptr && process != nullptr && process == std::to_string(getpid())) {
            logLine(
                "no collision dispatcher was made by way of a shared Bullet: nothing was taken over in this process");
        }
    }
} const atTheEnd;

}  // namespace

// Bullet's names as the loader knows them; `this` comes first.
#define GRAPESHOT_INTERPOSE(name) __asm__(name) __attribute__((visibility("default")))

using Construct = void(btCollisionDispatcher*, void*);
using Destroy = void(btCollisionDispatcher*);

constexpr char completeName[] = "_ZN21btCollisionDispatcherC1EP24btCollisionConfiguration";
constexpr char baseName[] = "_ZN21btCollisionDispatcherC2EP24btCollisionConfiguration";
constexpr char deletingName[] = "_ZN21btCollisionDispatcherD0Ev";
constexpr char destroyName[] = "_ZN21btCollisionDispatcherD1Ev";
constexpr char destroyBaseName[] = "_ZN21btCollisionDispatcherD2Ev";
constexpr char registerName[] = "_ZN27btGImpactCollisionAlgorithm17registerAlgorithmEP21btCollisionDispatcher";

extern "C" {
Construct construct GRAPESHOT_INTERPOSE("_ZN21btCollisionDispatcherC1EP24btCollisionConfiguration");
Construct constructBase GRAPESHOT_INTERPOSE("_ZN21btCollisionDispatcherC2EP24btCollisionConfiguration");
Destroy destroyAndDelete GRAPESHOT_INTERPOSE("_ZN21btCollisionDispatcherD0Ev");
Destroy destroy GRAPESHOT_INTERPOSE("_ZN21btCollisionDispatcherD1Ev");
Destroy destroyBase GRAPESHOT_INTERPOSE("_ZN21btCollisionDispatcherD2Ev");
Destroy registerGImpact
    GRAPESHOT_INTERPOSE("_ZN27btGImpactCollisionAlgorithm17registerAlgorithmEP21btCollisionDispatcher");

void construct(btCollisionDispatcher* dispatcher, void* configuration) {
    static void* const own = demand(completeName);
    reinterpret_cast<Construct*>(own)(dispatcher, configuration);
    takeOver(dispatcher, own);
}

/// Of a class derived from it.
void constructBase(btCollisionDispatcher* dispatcher, void* configuration) {
    static void* const own = demand(baseName);
    reinterpret_cast<Construct*>(own)(dispatcher, configuration);
    takeOver(dispatcher, own);
}

void destroyAndDelete(btCollisionDispatcher* dispatcher) {
    static void* const own = demand(deletingName);
    letGo(dispatcher);
    reinterpret_cast<Destroy*>(own)(dispatcher);
}

void destroy(btCollisionDispatcher* dispatcher) {
    static void* const own = demand(destroyName);
    letGo(dispatcher);
    reinterpret_cast<Destroy*>(own)(dispatcher);
}

void destroyBase(btCollisionDispatcher* dispatcher) {
    static void* const own = demand(destroyBaseName);
    letGo(dispatcher);
    reinterpret_cast<Destroy*>(own)(dispatcher);
}

/// GImpact takes places that were ours.
void registerGImpact(btCollisionDispatcher* dispatcher) {
    static void* const own = demand(registerName);
    reinterpret_cast<Destroy*>(own)(dispatcher);
    takeOver(dispatcher, demand(completeName));
}
}
