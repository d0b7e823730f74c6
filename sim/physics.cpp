// SPDX-License-Identifier: BSD-3-Clause
#include "sim/physics.h"

#include "base/error.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace adit {
namespace {

constexpr double gravity_mps2 = 9.81;
constexpr double brake_Nm = 80;
constexpr int rolling_iterations = 20, braked_iterations = 100;  // held wheels make a stiff chain from rock to frame
constexpr double same_surface_m = 1e-3;  // a contact this far above a deeper one's plane is a surface of its own
constexpr double sideways =
    0.57;  // sine of the steepest side slope that a tyre stands on; beyond, a wheel has no flank
constexpr int rock_group = 1, vehicle_group = 4;  // not 2: Bullet's static group shuns it
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

class Mine : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
  const btRigidBody* frame = nullptr;

  void performDiscreteCollisionDetection() override {
    const auto each_wheel = [&](auto&& f) {
      for (int i = 0; i < getDispatcher()->getNumManifolds(); ++i) {
        btPersistentManifold& m = *getDispatcher()->getManifoldByIndexInternal(i);
        if (m.getBody0()->getUserIndex() == wheel_index || m.getBody1()->getUserIndex() == wheel_index) f(m);
      }
    };
    each_wheel([](btPersistentManifold& m) { m.clearManifold(); });
    btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
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
  double step_s;
  btTriangleIndexVertexArray triangles;
  std::unique_ptr<btBvhTriangleMeshShape> rock_shape;
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

  Impl(const Mesh& mesh, const Vehicle& vehicle_, const Pose& X_WB, double step) : vehicle(vehicle_), step_s(step) {
    world.setGravity({0, 0, -gravity_mps2});
    world.getSolverInfo().m_solverMode |=
        SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    add_rock(mesh);
    add_frame(X_WB);
    for (const Wheel& wheel : vehicle.wheels) add_wheel(wheel, X_WB);
    world.frame = frame.get();
  }
  ~Impl() {
    for (auto& joint : joints) world.removeConstraint(joint.get());
    for (auto& wheel : wheels) world.removeRigidBody(wheel.get());
    world.removeRigidBody(frame.get());
    world.removeCollisionObject(rock.get());
  }

  void add_rock(const Mesh& mesh) {
    const int faces = static_cast<int>(mesh.face.size());
    for (int first = 0; first < faces; first += part_faces) {
      btIndexedMesh part;
      part.m_numTriangles = std::min(part_faces, faces - first);
      part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(mesh.face.data() + first);
      part.m_triangleIndexStride = sizeof(mesh.face[0]);
      part.m_numVertices = static_cast<int>(mesh.vertex.size());
      part.m_vertexBase = reinterpret_cast<const unsigned char*>(mesh.vertex.data());
      part.m_vertexStride = sizeof(mesh.vertex[0]);
      part.m_vertexType = PHY_DOUBLE;
      triangles.addIndexedMesh(part, PHY_INTEGER);
    }
    rock_shape = std::make_unique<btBvhTriangleMeshShape>(&triangles, true);
    rock_shape->setMargin(0.002);
    rock = std::make_unique<btCollisionObject>();
    rock->setCollisionShape(rock_shape.get());
    rock->setFriction(1);  // the wheel's or the frame's coefficient counts
    rock->setRestitution(0);
    world.addCollisionObject(rock.get(), rock_group, vehicle_group);
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
                        const btTransform& at, double friction) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, bt(inertia));
    info.m_startWorldTransform = at;
    info.m_friction = friction;
    slot = std::make_unique<btRigidBody>(info);
    slot->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(slot.get(), vehicle_group, rock_group);
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
    if (wheel.kind == Wheel::fixed)
      joints.push_back(std::make_unique<btHingeConstraint>(*frame, *body, pivot, none, axle, axle));
    else
      joints.push_back(std::make_unique<btPoint2PointConstraint>(*frame, *body, pivot, none));
    world.addConstraint(joints.back().get(), true);
  }

  void apply(const Effort& effort) {
    const btMatrix3x3 R = frame->getWorldTransform().getBasis();
    frame->applyForce(R * btVector3(effort.force_N, 0, 0), R * bt(Vec3(vehicle.handle_B - vehicle.centre_of_mass_B)));
    frame->applyTorque(R * btVector3(0, 0, effort.moment_Nm));
    for (size_t k = 0; k < wheels.size(); ++k) {
      const Wheel& wheel = vehicle.wheels[k];
      btVector3 spin = wheels[k]->getAngularVelocity() - frame->getAngularVelocity();
      if (wheel.kind == Wheel::fixed) {
        const btVector3 axle = R.getColumn(1);
        spin = axle * axle.dot(spin);
        static_cast<btHingeConstraint&>(*joints[k]).enableAngularMotor(effort.brake, 0, brake_Nm * step_s);
      }
      wheels[k]->applyTorque(bearing_moment(spin, wheel.bearing_Nm));
    }
  }
};

Physics::Physics(const Mesh& rock, const Vehicle& vehicle, const Pose& X_WB, double step_s)
    : impl_(std::make_unique<Impl>(rock, vehicle, X_WB, step_s)) {}
Physics::~Physics() = default;

void Physics::step(const Effort& effort) {
  impl_->apply(effort);
  impl_->world.getSolverInfo().m_numIterations = effort.brake ? braked_iterations : rolling_iterations;
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
  const auto of = [](const btRigidBody& body, double mass) {
    const btVector3 omega_B = body.getWorldTransform().getBasis().transpose() * body.getAngularVelocity();
    return 0.5 * mass * body.getLinearVelocity().length2() + 0.5 * omega_B.dot(omega_B * body.getLocalInertia()) +
           mass * gravity_mps2 * body.getWorldTransform().getOrigin().z();
  };
  double sum = of(*impl_->frame, impl_->vehicle.mass_kg);
  for (size_t k = 0; k < impl_->wheels.size(); ++k) sum += of(*impl_->wheels[k], impl_->vehicle.wheels[k].mass_kg);
  return sum;
}

std::optional<size_t> Physics::touched_face() const {
  std::optional<size_t> face;
  double deepest = 0.005;
  for (int i = 0; i < impl_->dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& m = *impl_->dispatcher.getManifoldByIndexInternal(i);
    const bool frame_is_a = m.getBody0()->getUserIndex() == frame_index;
    if (!frame_is_a && m.getBody1()->getUserIndex() != frame_index) continue;
    for (int k = 0; k < m.getNumContacts(); ++k) {
      const btManifoldPoint& p = m.getContactPoint(k);
      if (p.getDistance() >= deepest) continue;
      deepest = p.getDistance();
      const int part = frame_is_a ? p.m_partId1 : p.m_partId0, index = frame_is_a ? p.m_index1 : p.m_index0;
      face = static_cast<size_t>(part) * part_faces + static_cast<size_t>(index);
    }
  }
  return face;
}

}  // namespace adit
