// `cloth`: sheets over a torus, a comb and a fan of blades, and a garment on a moving body.
#include <functional>
#include <utility>

#include "cloth_scenes.hpp"

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): what CLI11 says of wrong declarations
    using namespace grapeshot;
    cloth::ClothSettings settings;
    soft::DemoOptions options;
    std::string only = "all";
    CLI::App app(
        "Sheets over a torus, a comb and a fan of blades, and a garment on a moving body; each collides with itself.\n"
        "Prints times per frame of 1/30 s. Exit code: 0, 1 (something passed through or was lost), 2 (bad use).",
        "cloth");
    soft::addOptions(app, options);
    app.add_option("--nodes", settings.nodes, "along an edge of a sheet")
        ->check(CLI::Range(9, 300))
        ->capture_default_str();
    app.add_option("--scene", only, "which of them")
        ->check(CLI::IsMember({"all", "torus", "comb", "blades", "garment"}))
        ->capture_default_str();
    return soft::runMain(app, argc, argv, [&] {
        std::vector<soft::SceneMaker> makers;
        for (const auto& [name, make] : {std::pair{"torus", &cloth::overTorus},
                                         {"comb", &cloth::overComb},
                                         {"blades", &cloth::overBlades},
                                         {"garment", &cloth::garment}}) {
            if (only == "all" || only == name) {
                makers.emplace_back(
                    [&, maker = make](soft::Method method) { return maker(method, settings, options); });
            }
        }
        return soft::demo("cloth", options, makers);
    });
}
