#include "pictures.hpp"

#include <algorithm>
#include <string>

#include <scenes/picture.hpp>
#include <scenes/plot.hpp>

namespace grapeshot::cannonball {

using scenes::Canvas;
using scenes::Colour;

namespace {

const Colour ink{0.12F, 0.12F, 0.14F};
const scenes::Camera camera{.eye = {-11.6, 5.4, -6.9}, .target = {-0.75, 0.95, -1.35}, .fieldOfView = 32};

Colour colourOfBlock(std::size_t index) {
    const auto shade = static_cast<float>(0.94 + 0.03 * static_cast<double>(index * 7 % 5));
    return shade * Colour(0.93F, 0.86F, 0.73F);
}

/// Iron, tinted like the ball's path.
Colour colourOfBall(std::size_t index) {
    return 0.45F * Colour(0.40F, 0.42F, 0.46F) + 0.55F * scenes::seriesColour(index);
}

scenes::Picture scenePicture(const Shot& shot, const scenes::Frame& frame, int width, int height) {
    const scenes::World& world = shot.scene.world;
    scenes::Picture picture(width, height, camera);
    picture.ground();
    const auto visible = [&](std::size_t body) { return frame[body].translation.allFinite(); };
    for (std::size_t body = 0; body < world.bodies(); ++body) {
        if (world.moving(body) && visible(body)) {
            picture.shadow(world.mesh(body), frame[body]);
        }
    }
    picture.blendShadows();
    const auto drawAll = [&](const std::vector<std::size_t>& bodies, Colour (*colour)(std::size_t)) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            if (visible(bodies[i])) {
                picture.mesh(world.mesh(bodies[i]), frame[bodies[i]], colour(i));
            }
        }
    };
    drawAll(shot.scene.blocks, colourOfBlock);
    drawAll(shot.scene.balls, colourOfBall);
    return picture;
}

}  // namespace

Canvas sideBySide(const std::vector<Panel>& panels) {
    const int width = panels.size() > 1 ? 960 : 1280;
    const int height = panels.size() > 1 ? 600 : 720;
    Canvas canvas(width * static_cast<int>(panels.size()), height, {1, 1, 1});
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const Panel& panel = panels[i];
        scenes::Picture picture = scenePicture(*panel.shot, panel.shot->frames[panel.frame], width, height);
        picture.canvas().text({24, 40}, panel.title, 15, ink);
        canvas.paste(picture.canvas(), width * static_cast<int>(i), 0);
        if (i > 0) {
            canvas.rectangle({width * static_cast<double>(i) - 1, 0}, {2, height}, {1, 1, 1});
        }
    }
    return canvas;
}

Canvas withPaths(const Shot& shot, const std::vector<Paths>& pathsOfShots, const std::string& title) {
    scenes::Picture picture = scenePicture(shot, shot.frames.back(), 1600, 900);
    // The perturbed ones first; the shot that the scene shows lies on top of them.
    for (std::size_t i = pathsOfShots.size(); i-- > 0;) {
        for (std::size_t ball = 0; ball < pathsOfShots[i].size(); ++ball) {
            const Colour colour = 0.9F * scenes::seriesColour(ball);
            picture.path(pathsOfShots[i][ball], i == 0 ? 2.6 : 1.3, colour, i == 0 ? 0.95F : 0.6F);
        }
    }
    Canvas& canvas = picture.canvas();
    canvas.text({30, 48}, title, 18, ink);
    double y = 84;
    for (std::size_t ball = 0; ball < shot.scene.ballNames.size(); ++ball, y += 24) {
        canvas.rectangle({31, y - 9}, {26, 6}, 0.9F * scenes::seriesColour(ball));
        canvas.text({66, y}, shot.scene.ballNames[ball], 12, ink);
    }
    return std::move(canvas);
}

Canvas stepTimes(const std::vector<const Shot*>& shots) {
    scenes::Plot plot{.title = "Time per step of 1/120 s of the same scene",
                      .xLabel = "simulated time [s]",
                      .yLabel = "processor time per step [ms]",
                      .logY = true,
                      .lines = {}};
    for (std::size_t i = 0; i < shots.size(); ++i) {
        const scenes::WorldSettings& settings = shots[i]->scene.world.settings();
        scenes::Line line;
        line.label = scenes::title(settings.engine);
        line.colour = scenes::seriesColour(1 - i % 2);
        for (std::size_t step = 0; step < shots[i]->records.size(); ++step) {
            line.x.push_back(settings.timeStep * static_cast<double>(step + 1));
            line.y.push_back(1e3 * shots[i]->records[step].cpuSeconds);
        }
        plot.lines.push_back(std::move(line));
    }
    return scenes::draw(plot);
}

}  // namespace grapeshot::cannonball
