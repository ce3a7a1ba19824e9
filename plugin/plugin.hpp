// All that a Bullet program needs.
#pragma once

#include <grapeshot/plugin/collision_algorithm.hpp>
#include <grapeshot/plugin/debug_draw.hpp>
#include <grapeshot/plugin/diagnose.hpp>
#include <grapeshot/plugin/dispatcher.hpp>
#include <grapeshot/plugin/foreign_hierarchy.hpp>
#include <grapeshot/plugin/mass_properties.hpp>
#include <grapeshot/plugin/registration.hpp>
#include <grapeshot/plugin/settings.hpp>
#include <grapeshot/plugin/shadow.hpp>
#include <grapeshot/plugin/shape_cache.hpp>
#include <grapeshot/plugin/soft_body_solver.hpp>
#include <grapeshot/plugin/soft_contacts.hpp>
#include <grapeshot/plugin/state.hpp>
#include <grapeshot/plugin/statistics.hpp>
#include <grapeshot/plugin/status.hpp>
#include <grapeshot/plugin/swept_world.hpp>
