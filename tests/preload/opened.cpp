// Opens a plugin that is linked with Bullet, and keeps its names to itself. usage: opened PLUGIN arguments...
#include <dlfcn.h>

#include <cstdio>

int main(int argc, char** argv) {
    void* plugin = argc > 1 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : nullptr;
    if (plugin == nullptr) {
        std::fprintf(stderr, "%s\n", argc > 1 ? dlerror() : "which plugin?");
        return 2;
    }
    auto* run = reinterpret_cast<int (*)(int, char**)>(dlsym(plugin, "fallingMesh"));
    return run(argc - 1, argv + 1);
}
