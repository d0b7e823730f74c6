// SPDX-License-Identifier: BSD-3-Clause
#include "sim/physics.h"

#include "base/error.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace adit {
namespace {

constexpr double gravity_mps2 = 9.81;
constexpr int rolling_iterations = 20, braked_iterations = 100;  // held wheels make a stiff chain from rock to frame
constexpr double climbing_deg = 2, climbing_iterations = 5;  // for motors: more for each degree of slope beyond that
constexpr int climbing_iterations_max = 60;
constexpr double same_surface_m = 1e-3;  // a contact this far above a deeper one's plane is a surface of its own
constexpr double sideways =
    0.57;                      // sine of the steepest side slope that a tyre stands on; beyond, a wheel has no flank
constexpr double steep = 0.5;  // upward part of a normal: what is steeper is no ground
constexpr double relief_margin_m = 0.02;
constexpr int rock_group = 1, vehicle_group = 4, loose_group = 8;  // not 2: Bullet's static group shuns it
constexpr double rock_reach_m = 0.15;
constexpr int wheel_index = 1, frame_index = 2;
constexpr int part_faces = 1 << 20;  // Bullet's triangle index has 21 bits within a part

btVector3 bt(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Vec3 vec(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
btTransform bt(const Pose& X) {
  const Eigen::Quaterniond q(X.linear());
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), bt(Vec3(X.translation())));
}
Pose pose(const btTransform& t) {
  const btQuaternion q = t.getRotation();
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
  X.translation() = vec(t.getOrigin());
  return X;
}

// Of the mesh, by Bullet's numbers.
size_t face_number(int part, int index) {
  return static_cast<size_t>(part) * part_faces + static_cast<size_t>(index);
}

// Drops the contacts of a ball that are none: those on edges that a deeper contact's plane already holds up, and those
// at its flanks, where a wheel has no tread.
void keep_true_contacts(btPersistentManifold& manifold, const btVector3& axle) {
  const auto depth = [&](int i) { return manifold.getContactPoint(i).getDistance(); };
  for (int i = manifold.getNumContacts() - 1; i >= 0; --i)
    if (std::abs(manifold.getContactPoint(i).m_normalWorldOnB.dot(axle)) > sideways) manifold.removeContactPoint(i);
  const bool wheel_is_a = manifold.getBody0()->getUserIndex() == wheel_index;
  const auto on_rock = [&](const btManifoldPoint& p) {
    return wheel_is_a ? p.m_positionWorldOnB : p.m_positionWorldOnA;
  };
  for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
    const btManifoldPoint& mine = manifold.getContactPoint(i);
    bool held = false;
    for (int j = 0; j < manifold.getNumContacts() && !held; ++j) {
      if (j == i || depth(j) > depth(i) || (depth(j) == depth(i) && j > i)) continue;
      const btManifoldPoint& deeper = manifold.getContactPoint(j);
      const btVector3 up = wheel_is_a ? deeper.m_normalWorldOnB : -deeper.m_normalWorldOnB;
      held = (on_rock(mine) - on_rock(deeper)).dot(up) <= same_surface_m;
    }
    if (held) manifold.removeContactPoint(i);
  }
}

// The rock, which knows the triangles about the places asked for last: what moves slowly is asked for again and again.
// Bullet's tree is asked for a box that reaches farther; of what it names, in its order, the triangles that touch the
// box asked for are handed on, as the tree itself would do.
// Vehicles go through faces of water: they are not handed on.
class RockShape : public btBvhTriangleMeshShape {
 public:
  RockShape(btStridingMeshInterface* triangles, const std::vector<Label>& label)
      : btBvhTriangleMeshShape(triangles, true), label_(label) {}

  void processAllTriangles(btTriangleCallback* callback, const btVector3& low, const btVector3& high) const override {
    for (Triangle& t : about(low, high).triangles)
      if (TestAabbAgainstAabb2(t.low, t.high, low, high)) callback->processTriangle(t.corner, t.part, t.index);
  }

 private:
  struct Triangle {
    btVector3 corner[3], low, high;
    int part, index;
  };
  struct Place {
    btVector3 low{1, 1, 1}, high{0, 0, 0};
    std::vector<Triangle> triangles;
  };
  struct Keep : btTriangleCallback {
    const std::vector<Label>& label;
    std::vector<Triangle>& into;
    Keep(const std::vector<Label>& labels, std::vector<Triangle>& triangles) : label(labels), into(triangles) {}
    void processTriangle(btVector3* corner, int part, int index) override {
      if (!label.empty() && label[face_number(part, index)] == Label::water) return;
      Triangle t{{corner[0], corner[1], corner[2]}, corner[0], corner[0], part, index};
      for (int k = 1; k < 3; ++k) t.low.setMin(corner[k]), t.high.setMax(corner[k]);
      into.push_back(t);
    }
  };

  Place& about(const btVector3& low, const btVector3& high) const {
    const auto holds = [&](const Place& p) {
      for (int k = 0; k < 3; ++k)
        if (low[k] < p.low[k] || high[k] > p.high[k]) return false;
      return true;
    };
    for (Place& place : places_)
      if (holds(place)) return place;
    Place& place = places_[next_];
    next_ = (next_ + 1) % places_.size();
    const btVector3 reach(rock_reach_m, rock_reach_m, rock_reach_m);
    place.low = low - reach;
    place.high = high + reach;
    place.triangles.clear();
    Keep keep(label_, place.triangles);
    btBvhTriangleMeshShape::processAllTriangles(&keep, place.low, place.high);
    return place;
  }

  const std::vector<Label>& label_;  // of the mesh's faces, or empty
  mutable std::array<Place, 16> places_;
  mutable size_t next_ = 0;
};

// The face of the rock that a contact lies on.
size_t face_of(const btPersistentManifold& m, const btManifoldPoint& p) {
  const bool rock_is_b = m.getBody0()->getUserIndex() > 0;
  const int part = rock_is_b ? p.m_partId1 : p.m_partId0, index = rock_is_b ? p.m_index1 : p.m_index0;
  return face_number(part, index);
}

class Mine : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
  const btRigidBody* frame = nullptr;
  std::function<void()> lay_relief;  // in place of the floor's faces, where there is one

  void performDiscreteCollisionDetection() override {
    const auto each_wheel = [&](auto&& f) {
      for (int i = 0; i < getDispatcher()->getNumManifolds(); ++i) {
        btPersistentManifold& m = *getDispatcher()->getManifoldByIndexInternal(i);
        if (m.getBody0()->getUserIndex() == wheel_index || m.getBody1()->getUserIndex() == wheel_index) f(m);
      }
    };
    each_wheel([](btPersistentManifold& m) { m.clearManifold(); });
    btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
    if (lay_relief) lay_relief();
    const btVector3 axle = frame->getWorldTransform().getBasis().getColumn(1);
    each_wheel([&](btPersistentManifold& m) { keep_true_contacts(m, axle); });
  }
};

// A resistance that grows to its full value within half a radian per second, so that it never turns a wheel by itself.
btVector3 bearing_moment(const btVector3& spin, double bearing_Nm) {
  return spin * (-bearing_Nm / (spin.length() + 0.5));
}

}  // namespace

struct Physics::Impl {
  const Vehicle& vehicle;
  const Mesh& mesh;
  double step_s;
  btTriangleIndexVertexArray triangles;
  std::unique_ptr<RockShape> rock_shape;
  std::unique_ptr<btCollisionObject> rock;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  Mine world{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<btRigidBody> frame;
  std::vector<std::unique_ptr<btRigidBody>> wheels;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
  std::vector<std::unique_ptr<btRigidBody>> blocks;
  const Relief* relief;
  std::vector<btPersistentManifold*> treads;  // (wheels) contacts with the relief

  Impl(const Mesh& mesh_, const Vehicle& vehicle_, const Pose& X_WB, double step, const Relief* relief_,
       const std::vector<Loose>& loose)
      : vehicle(vehicle_), mesh(mesh_), step_s(step), relief(relief_) {
    world.setGravity({0, 0, -gravity_mps2});
    add_rock();
    add_frame(X_WB);
    for (const Wheel& wheel : vehicle.wheels) add_wheel(wheel, X_WB);
    for (const Loose& block : loose) add_loose(block);
    world.frame = frame.get();
    if (!relief) return;
    for (auto& wheel : wheels) treads.push_back(dispatcher.getNewManifold(wheel.get(), rock.get()));
    world.lay_relief = [this] { lay_relief(); };
  }
  ~Impl() {
    for (btPersistentManifold* tread : treads) dispatcher.releaseManifold(tread);
    for (auto& joint : joints) world.removeConstraint(joint.get());
    for (auto& block : blocks) world.removeRigidBody(block.get());
    for (auto& wheel : wheels) world.removeRigidBody(wheel.get());
    world.removeRigidBody(frame.get());
    world.removeCollisionObject(rock.get());
  }

  void add_rock() {
    const auto& face = mesh.face;
    const int faces = static_cast<int>(mesh.face.size());
    for (int first = 0; first < faces; first += part_faces) {
      btIndexedMesh part;
      part.m_numTriangles = std::min(part_faces, faces - first);
      part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(face.data() + first);
      part.m_triangleIndexStride = sizeof(face[0]);
      part.m_numVertices = static_cast<int>(mesh.vertex.size());
      part.m_vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertex.data());
      part.m_vertexStride = sizeof(mesh.vertex[0]);
      part.m_vertexType = PHY_DOUBLE;
      triangles.addIndexedMesh(part, PHY_INTEGER);
    }
    rock_shape = std::make_unique<RockShape>(&triangles, mesh.label);
    rock_shape->setMargin(0.002);
    rock = std::make_unique<btCollisionObject>();
    rock->setCollisionShape(rock_shape.get());
    rock->setFriction(1);  // the wheel's or the frame's coefficient counts
    rock->setRestitution(0);
    world.addCollisionObject(rock.get(), rock_group, vehicle_group | loose_group);
  }

  // Height of a wheel's middle above the level floor when the vehicle stands: radius less what its tyre gives way.
  double hub_height_m(const Wheel& wheel) const {
    // Load shared between front and rear as the centre of mass asks; equal within an axle.
    double front = -1e9, back = 1e9;
    for (const Wheel& w : vehicle.wheels)
      front = std::max(front, w.position_B.x()), back = std::min(back, w.position_B.x());
    const double middle = 0.5 * (front + back);
    int at_end = 0;
    for (const Wheel& w : vehicle.wheels) at_end += (w.position_B.x() > middle) == (wheel.position_B.x() > middle);
    const double to_front = (vehicle.centre_of_mass_B.x() - back) / (front - back);
    const double share = (wheel.position_B.x() > middle ? to_front : 1 - to_front) / at_end;
    return wheel.radius_m - (vehicle.mass_kg * share + wheel.mass_kg) * gravity_mps2 / wheel.stiffness_N_m;
  }

  btRigidBody* add_body(std::unique_ptr<btRigidBody>& slot, double mass, btCollisionShape* shape, const Vec3& inertia,
                        const btTransform& at, double friction, int group = vehicle_group,
                        int against = rock_group | loose_group) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, bt(inertia));
    info.m_startWorldTransform = at;
    info.m_friction = friction;
    slot = std::make_unique<btRigidBody>(info);
    slot->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(slot.get(), group, against);
    return slot.get();
  }

  void add_frame(const Pose& X_WB) {
    auto compound = std::make_unique<btCompoundShape>();
    for (const Box& box : vehicle.solid) {
      auto shape = std::make_unique<btBoxShape>(bt(Vec3(0.5 * (box.max_B - box.min_B))));
      shape->setMargin(0.005);
      btTransform at = btTransform::getIdentity();
      at.setOrigin(bt(Vec3(0.5 * (box.max_B + box.min_B) - vehicle.centre_of_mass_B)));
      compound->addChildShape(at, shape.get());
      shapes.push_back(std::move(shape));
    }
    const Pose X_WC = X_WB * Eigen::Translation3d(vehicle.centre_of_mass_B);
    add_body(frame, vehicle.mass_kg, compound.get(), vehicle.inertia_kg_m2, bt(X_WC), 0.3)->setUserIndex(frame_index);
    shapes.push_back(std::move(compound));
  }

  void add_wheel(const Wheel& wheel, const Pose& X_WB) {
    auto ball = std::make_unique<btSphereShape>(wheel.radius_m);
    const Vec3 hub_B(wheel.position_B.x(), wheel.position_B.y(), hub_height_m(wheel));
    const double inertia = 0.4 * wheel.mass_kg * wheel.radius_m * wheel.radius_m;
    wheels.emplace_back();
    btRigidBody* body = add_body(wheels.back(), wheel.mass_kg, ball.get(), Vec3::Constant(inertia),
                                 bt(Pose(X_WB * Eigen::Translation3d(hub_B))), wheel.friction);
    shapes.push_back(std::move(ball));
    body->setUserIndex(wheel_index);
    body->setContactStiffnessAndDamping(wheel.stiffness_N_m, wheel.damping_N_s_m);
    const btVector3 pivot = bt(Vec3(hub_B - vehicle.centre_of_mass_B)), none(0, 0, 0), axle(0, 1, 0);
    if (wheel.kind != Wheel::castor)
      joints.push_back(std::make_unique<btHingeConstraint>(*frame, *body, pivot, none, axle, axle));
    else
      joints.push_back(std::make_unique<btPoint2PointConstraint>(*frame, *body, pivot, none));
    world.addConstraint(joints.back().get(), true);
  }

  void add_loose(const Loose& block) {
    auto shape = std::make_unique<btBoxShape>(bt(Vec3(0.5 * block.size_m)));
    shape->setMargin(0.005);
    btVector3 inertia;
    shape->calculateLocalInertia(block.mass_kg, inertia);
    blocks.emplace_back();
    add_body(blocks.back(), block.mass_kg, shape.get(), vec(inertia), bt(block.X_WL), block.friction, loose_group,
             rock_group | vehicle_group | loose_group);
    shapes.push_back(std::move(shape));
  }

  // Takes the floor's faces off the wheels and puts the places there at which they touch the relief.
  void lay_relief() {
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      btPersistentManifold& m = *dispatcher.getManifoldByIndexInternal(i);
      const bool with_rock = m.getBody0() == rock.get() || m.getBody1() == rock.get();
      if (!with_rock || std::max(m.getBody0()->getUserIndex(), m.getBody1()->getUserIndex()) != wheel_index) continue;
      for (int k = m.getNumContacts() - 1; k >= 0; --k) {
        const size_t face = face_of(m, m.getContactPoint(k));
        if (face >= mesh.label.size() || is_ground(mesh.label[face])) m.removeContactPoint(k);
      }
    }
    const btVector3 x = frame->getWorldTransform().getBasis().getColumn(0);
    const double level = std::hypot(x.x(), x.y());
    const Vec2 ahead = level > 1e-6 ? Vec2(Vec2(x.x(), x.y()) / level) : Vec2(1, 0);
    for (size_t w = 0; w < wheels.size(); ++w) {
      const Vec3 middle = vec(wheels[w]->getWorldTransform().getOrigin());
      for (const Touch& touch : relief->touches(middle, vehicle.wheels[w].radius_m, ahead, relief_margin_m))
        add_touch(w, touch);
    }
  }

  // As btManifoldResult::addContactPoint makes a contact of two bodies.
  void add_touch(size_t w, const Touch& touch) {
    const btRigidBody& wheel = *wheels[w];
    const btVector3 normal = bt(touch.normal_W), on_rock = bt(touch.p_W);
    const btVector3 on_wheel = on_rock + normal * touch.distance_m;
    btManifoldPoint p(wheel.getWorldTransform().inverse() * on_wheel, on_rock, normal, touch.distance_m);
    p.m_positionWorldOnA = on_wheel;
    p.m_positionWorldOnB = on_rock;
    p.m_partId0 = p.m_index0 = p.m_partId1 = p.m_index1 = -1;
    p.m_combinedFriction = vehicle.wheels[w].friction;
    p.m_contactPointFlags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
    p.m_combinedContactStiffness1 = vehicle.wheels[w].stiffness_N_m;
    p.m_combinedContactDamping1 = vehicle.wheels[w].damping_N_s_m;
    btPlaneSpace1(normal, p.m_lateralFrictionDir1, p.m_lateralFrictionDir2);
    treads[w]->addManifoldPoint(p);
  }

  // Motors: one force against the slip as a whole, which lets scrubbing tyres turn as Coulomb's law has it. Hands, and all
  // that stands: two forces along fixed axes, which hold without a tremble.
  void choose_friction(bool brake) {
    constexpr int fixed_axes = SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    int& mode = world.getSolverInfo().m_solverMode;
    mode = vehicle.drivetrain == Drivetrain::skid_steer && !brake ? mode & ~fixed_axes : mode | fixed_axes;
  }

  // On a slope the wheels, light beside the frame, must hold it up within one step, or they creep back by what is left
  // undone: 8 % of 0.15 m/s at 10 degrees with 20 iterations. Hands push the frame itself.
  int iterations(bool brake) const {
    if (brake) return braked_iterations;
    if (vehicle.drivetrain == Drivetrain::pushed) return rolling_iterations;
    const double up = std::clamp<double>(frame->getWorldTransform().getBasis().getColumn(2).z(), -1, 1);
    const double beyond_deg = std::max(0.0, std::acos(up) * 180 / std::numbers::pi - climbing_deg);
    return std::min(rolling_iterations + static_cast<int>(climbing_iterations * beyond_deg), climbing_iterations_max);
  }

  // Of the rock's faces that a body of that kind is nearer to than margin_m, not counting those flatter than asked.
  std::optional<size_t> deepest_face(int body, double margin_m, double normal_up_below) const {
    std::optional<size_t> face;
    double deepest = margin_m;
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& m = *const_cast<btCollisionDispatcher&>(dispatcher).getManifoldByIndexInternal(i);
      const btCollisionObject *a = m.getBody0(), *b = m.getBody1();
      if ((a != rock.get() && b != rock.get()) || (a->getUserIndex() != body && b->getUserIndex() != body)) continue;
      for (int k = 0; k < m.getNumContacts(); ++k) {
        const btManifoldPoint& p = m.getContactPoint(k);
        const size_t of_rock = face_of(m, p);
        if (p.getDistance() >= deepest || of_rock >= mesh.face.size()) continue;
        if (std::abs(p.m_normalWorldOnB.z()) > normal_up_below) continue;
        deepest = p.getDistance();
        face = of_rock;
      }
    }
    return face;
  }

  void apply(const Effort& effort) {
    const btMatrix3x3 R = frame->getWorldTransform().getBasis();
    frame->applyForce(R * btVector3(effort.force_N, 0, 0), R * bt(Vec3(vehicle.handle_B - vehicle.centre_of_mass_B)));
    frame->applyTorque(R * btVector3(0, 0, effort.moment_Nm));
    for (size_t k = 0; k < wheels.size(); ++k) {
      const Wheel& wheel = vehicle.wheels[k];
      btVector3 spin = wheels[k]->getAngularVelocity() - frame->getAngularVelocity();
      if (wheel.kind != Wheel::castor) {
        const btVector3 axle = R.getColumn(1);
        spin = axle * axle.dot(spin);
        auto& hinge = static_cast<btHingeConstraint&>(*joints[k]);
        const bool motor = wheel.kind == Wheel::driven && !effort.brake;
        const double tread = wheel.position_B.y() > 0 ? effort.left_mps : effort.right_mps;
        // The motor's sense is that of the frame about the wheel. It bears the bearing's resistance itself: a moment of
        // its own would turn the slip, and with it the friction, before the motor acts.
        hinge.enableAngularMotor(effort.brake || motor, motor ? -tread / wheel.radius_m : 0,
                                 (motor ? vehicle.motors.torque_max_Nm - wheel.bearing_Nm : wheel.brake_Nm) * step_s);
        if (motor) continue;
      }
      wheels[k]->applyTorque(bearing_moment(spin, wheel.bearing_Nm));
    }
  }
};

Physics::Physics(const Mesh& rock, const Vehicle& vehicle, const Pose& X_WB, double step_s, const Relief* relief,
                 const std::vector<Loose>& loose)
    : impl_(std::make_unique<Impl>(rock, vehicle, X_WB, step_s, relief, loose)) {}
Physics::~Physics() = default;

void Physics::step(const Effort& effort) {
  impl_->apply(effort);
  impl_->choose_friction(effort.brake);
  impl_->world.getSolverInfo().m_numIterations = impl_->iterations(effort.brake);
  impl_->world.stepSimulation(impl_->step_s, 0);  // exactly one step of this length
}

Motion Physics::motion() const {
  const btRigidBody& frame = *impl_->frame;
  Motion motion;
  motion.X_WB = pose(frame.getWorldTransform()) * Eigen::Translation3d(-impl_->vehicle.centre_of_mass_B);
  motion.omega_W = vec(frame.getAngularVelocity());
  const Vec3 lever = motion.X_WB.linear() * -impl_->vehicle.centre_of_mass_B;
  motion.v_W = vec(frame.getLinearVelocity()) + motion.omega_W.cross(lever);
  return motion;
}

Motion Physics::loose_motion(size_t k) const {
  const btRigidBody& block = *impl_->blocks[k];
  return {pose(block.getWorldTransform()), vec(block.getLinearVelocity()), vec(block.getAngularVelocity())};
}

void Physics::rest() {
  const btVector3 none(0, 0, 0);
  const auto stop = [&](btRigidBody& body) {
    body.setLinearVelocity(none);
    body.setAngularVelocity(none);
  };
  stop(*impl_->frame);
  for (auto& wheel : impl_->wheels) stop(*wheel);
}

double Physics::energy_J() const {
  const auto of = [](const btRigidBody& body) {
    const double mass = 1 / body.getInvMass();
    const btVector3 omega_B = body.getWorldTransform().getBasis().transpose() * body.getAngularVelocity();
    return 0.5 * mass * body.getLinearVelocity().length2() + 0.5 * omega_B.dot(omega_B * body.getLocalInertia()) +
           mass * gravity_mps2 * body.getWorldTransform().getOrigin().z();
  };
  double sum = of(*impl_->frame);
  for (const auto& wheel : impl_->wheels) sum += of(*wheel);
  for (const auto& block : impl_->blocks) sum += of(*block);
  return sum;
}

std::optional<size_t> Physics::touched_face() const {
  return impl_->deepest_face(frame_index, 0.005, 2);
}

std::optional<size_t> Physics::face_at_wheel() const {
  return impl_->deepest_face(wheel_index, 0.005, steep);
}

}  // namespace adit
