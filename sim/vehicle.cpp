// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle.h"

#include "base/config.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

using Numbers = std::vector<double>;

Vec3 vec3(const Document& document, const std::string& key, const Numbers& v) {
  if (v.size() != 3) document.fail(key, "must be three numbers [x, y, z] in metres");
  return {v[0], v[1], v[2]};
}

Wheel read_wheel(const Document& table) {
  Wheel wheel;
  std::string kind = "fixed";
  Numbers position;
  table.read({{"name", &wheel.name, "what errors and reports call it"},
              {"kind",
               &kind,
               "fixed: rolls along x only; castor: in any direction; driven: by a motor",
               {"fixed", "castor", "driven"}},
              {"position_m", &position, "x and y of its middle in B"},
              {"radius_m", &wheel.radius_m, "", 0.02, 2},
              {"mass_kg", &wheel.mass_kg, "", 0.1, 500},
              {"stiffness_n_m", &wheel.stiffness_N_m, "of the tyre", 1e3, 1e7},
              {"damping_n_s_m", &wheel.damping_N_s_m, "of the tyre", 1, 1e6},
              {"friction", &wheel.friction, "coefficient against rock", 0, 5},
              {"bearing_nm", &wheel.bearing_Nm, "moment that resists rolling", 0, 1000},
              {"brake_nm", &wheel.brake_Nm, "moment that holds it when the vehicle stands", 0, 1e5}});
  for (const char* key : {"position_m", "radius_m", "mass_kg", "stiffness_n_m", "damping_n_s_m", "friction"})
    if (!table.has(key)) table.fail(key, "is missing: every wheel states it");
  if (position.size() != 2) table.fail("position_m", "must be two numbers [x, y] in metres");
  wheel.kind = kind == "castor" ? Wheel::castor : kind == "driven" ? Wheel::driven : Wheel::fixed;
  wheel.position_B = {position[0], position[1]};
  return wheel;
}

void read_box(const Document& table, Vehicle& vehicle) {
  Box box;
  Numbers low, high;
  std::string label = "vehicle";
  bool solid = false;
  table.read({{"name", &box.name, ""},
              {"min_m", &low, "lower corner in B"},
              {"max_m", &high, "upper corner in B"},
              {"label", &label, "what a laser that hits it records", {"vehicle", "pusher"}},
              {"solid", &solid, "whether it collides with rock"}});
  box.min_B = vec3(table, "min_m", low);
  box.max_B = vec3(table, "max_m", high);
  if ((box.max_B - box.min_B).minCoeff() <= 0) table.fail("max_m", "must exceed min_m along x, y and z");
  box.label = label == "pusher" ? Label::pusher : Label::vehicle;
  vehicle.hull.push_back(box);
  if (solid) vehicle.solid.push_back(box);
}

void check(const Document& document, const Vehicle& vehicle) {
  if (vehicle.wheels.size() < 3) document.fail("wheel", "a vehicle stands on three wheels or more");
  const auto count = [&](Wheel::Kind kind) {
    return std::count_if(vehicle.wheels.begin(), vehicle.wheels.end(), [&](const Wheel& w) { return w.kind == kind; });
  };
  if (vehicle.drivetrain == Drivetrain::pushed && count(Wheel::driven) > 0)
    document.fail("wheel", "a pushed vehicle has no wheels of kind \"driven\"");
  if (vehicle.drivetrain == Drivetrain::pushed && count(Wheel::fixed) == 0)
    document.fail("wheel",
                  "at least one must be of kind \"fixed\", or nothing keeps the vehicle from drifting sideways");
  if (vehicle.drivetrain == Drivetrain::skid_steer && (count(Wheel::driven) < 2 || vehicle.track_m() < 0.05))
    document.fail("wheel", "a skid-steer needs wheels of kind \"driven\" on both sides");
  const auto [back, front] = std::minmax_element(vehicle.wheels.begin(), vehicle.wheels.end(),
                                                 [](auto& a, auto& b) { return a.position_B.x() < b.position_B.x(); });
  const double x = vehicle.centre_of_mass_B.x();
  if (x <= back->position_B.x() || x >= front->position_B.x())
    document.fail("centre_of_mass_m", "lies outside of the wheels: the vehicle would tip where it stands");
  if (vehicle.solid.empty()) document.fail("box", "at least one must be solid, or the vehicle drives through rock");
}

}  // namespace

double Vehicle::total_mass_kg() const {
  double mass = mass_kg;
  for (const Wheel& wheel : wheels) mass += wheel.mass_kg;
  return mass;
}

double Vehicle::axle_x_m() const {
  double sum = 0;
  int n = 0;
  for (const Wheel& wheel : wheels)
    if (wheel.kind != Wheel::castor) sum += wheel.position_B.x(), ++n;
  return n > 0 ? sum / n : 0;
}

double Vehicle::track_m() const {
  double left = 0, right = 0;
  int on_left = 0, on_right = 0;
  for (const Wheel& wheel : wheels) {
    if (wheel.kind != Wheel::driven) continue;
    const double y = wheel.position_B.y();
    (y > 0 ? left : right) += y;
    ++(y > 0 ? on_left : on_right);
  }
  return on_left > 0 && on_right > 0 ? left / on_left - right / on_right : 0;
}

double Vehicle::width_m() const {
  double low = 0, high = 0;
  for (const Box& box : hull) {
    if (box.label == Label::pusher) continue;
    low = std::min(low, box.min_B.y());
    high = std::max(high, box.max_B.y());
  }
  return high - low;
}

Vehicle load_vehicle(const std::string& name_or_file) {
  const Document document = Document::find("sim/vehicles", name_or_file);
  Vehicle vehicle;
  std::string drive;
  Numbers centre, inertia, handle;
  double turn_max_deg_s = 0;
  document.read({{"name", &vehicle.name, ""},
                 {"drive", &drive, "a person pushes, or the wheels of each side are driven", {"pushed", "skid_steer"}},
                 {"mass_kg", &vehicle.mass_kg, "without wheels", 0.1, 1e5},
                 {"centre_of_mass_m", &centre, "without wheels, in B"},
                 {"inertia_kg_m2", &inertia, "about the centre of mass, along x, y, z"},
                 {"push.handle_m", &handle, "where it is pushed, in B"},
                 {"push.force_max_n", &vehicle.force_max_N, "", 1, 1e5},
                 {"push.moment_max_nm", &vehicle.moment_max_Nm, "", 1, 1e5},
                 {"motors.torque_max_nm", &vehicle.motors.torque_max_Nm, "of each wheel", 0.1, 1e5},
                 {"motors.speed_max_mps", &vehicle.motors.speed_max_mps, "of a wheel's tread", 0.02, 10},
                 {"motors.acceleration_mps2", &vehicle.motors.acceleration_mps2, "", 0.01, 10},
                 {"motors.turn_max_deg_s", &turn_max_deg_s, "turn rate asked at most", 0.5, 360},
                 {"motors.turn_gain", &vehicle.motors.turn_gain, "against wheels that do not slip", 0.5, 20}},
                {"wheel", "box"});
  using Keys = std::vector<const char*>;
  const auto demand = [&](const Keys& keys, const char* who) {
    for (const char* key : keys)
      if (!document.has(key)) document.fail(key, std::string("is missing: every ") + who + " states it");
  };
  const auto refuse = [&](const Keys& keys, const char* who) {
    for (const char* key : keys)
      if (document.has(key)) document.fail(key, std::string("has no meaning for a ") + who);
  };
  const Keys push = {"push.handle_m", "push.force_max_n", "push.moment_max_nm"},
             motors = {"motors.torque_max_nm", "motors.speed_max_mps", "motors.acceleration_mps2",
                       "motors.turn_max_deg_s", "motors.turn_gain"};
  demand({"name", "mass_kg", "centre_of_mass_m", "inertia_kg_m2"}, "vehicle");
  vehicle.drivetrain = drive == "skid_steer" ? Drivetrain::skid_steer : Drivetrain::pushed;
  const bool pushed = vehicle.drivetrain == Drivetrain::pushed;
  demand(pushed ? push : motors, pushed ? "pushed vehicle" : "skid-steer");
  refuse(pushed ? motors : push, pushed ? "pushed vehicle" : "skid-steer");
  vehicle.centre_of_mass_B = vec3(document, "centre_of_mass_m", centre);
  vehicle.inertia_kg_m2 = vec3(document, "inertia_kg_m2", inertia);
  if (pushed) vehicle.handle_B = vec3(document, "push.handle_m", handle);
  vehicle.motors.turn_max_rad_s = turn_max_deg_s * std::numbers::pi / 180;
  if (vehicle.inertia_kg_m2.minCoeff() <= 0) document.fail("inertia_kg_m2", "must be three positive numbers");
  for (const Document& table : document.tables("wheel")) vehicle.wheels.push_back(read_wheel(table));
  for (const Document& table : document.tables("box")) read_box(table, vehicle);
  check(document, vehicle);
  return vehicle;
}

}  // namespace adit
