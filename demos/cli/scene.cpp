// `grapeshot scene NAME FILE.bullet`: a small concave scene, written with Bullet's serializer.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <import/bullet_scene.hpp>
#include <memory>
#include <scenes/named_scenes.hpp>

#include <grapeshot/core/error.hpp>

#include "commands.hpp"

namespace grapeshot::cli {
namespace {

struct SceneOptions {
    std::string name;
    std::string file;
};

ExitCode writeScene(const SceneOptions& options) {
    scenes::World world;
    scenes::findScene(options.name)->fill(world);
    import::writeBulletFile(world.dynamics(), options.file);
    std::printf("%s: %zu bodies\n", options.file.c_str(), world.bodies());
    return done;
}

}  // namespace

void addScene(CLI::App& tool, std::function<ExitCode()>& run) {
    auto* command = tool.add_subcommand("scene", "Writes a small concave scene as a .bullet file");
    auto options = std::make_shared<SceneOptions>();
    std::vector<std::string> names;
    std::string all = "which one";
    for (const scenes::NamedScene& scene : scenes::namedScenes()) {
        names.emplace_back(scene.name);
        all += std::string("; ") + std::string(scene.name) + ": " + std::string(scene.title);
    }
    command->add_option("NAME", options->name, all)->required()->check(CLI::IsMember(names));
    command->add_option("FILE", options->file, "where to write it")->required();
    command->callback([options, &run] { run = [options] { return writeScene(*options); }; });
}

}  // namespace grapeshot::cli
