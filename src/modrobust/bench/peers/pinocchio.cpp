// Pinocchio's side of the comparison: its recursive Newton-Euler algorithm, header-only, on the robot
// and the states that program.c has read. Compiled once for all robots, because it takes minutes.
#include "peer.h"

#include <pinocchio/multibody.hpp>

#include <pinocchio/algorithm/rnea.hpp>

#include <memory>
#include <string>
#include <vector>

namespace {

struct Peer {
    pinocchio::Model model;
    std::unique_ptr<pinocchio::Data> data;
    std::vector<int> order;
    std::vector<Eigen::VectorXd> q, v, a;
};

Peer peer;

pinocchio::SE3 se3(const mr_transform &T) {
    return pinocchio::SE3(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(T.R),
                          Eigen::Map<const Eigen::Vector3d>(T.p));
}

} // namespace

void peer_load(const mr_model *model, const mr_parameters *nominal, const int32_t *order) {
    peer.model.gravity.linear() = Eigen::Map<const Eigen::Vector3d>(model->gravity);
    std::vector<pinocchio::JointIndex> ids(static_cast<size_t>(model->j));
    // Pinocchio's joint frame lies before our `after`, so that bodies and children carry it.
    for (int32_t k = 0; k < model->j; ++k) {
        const int32_t i = order[k], parent = model->parent[i];
        pinocchio::SE3 T = se3(model->before[i]);
        if (parent >= 0) T = se3(model->after[parent]) * T;
        const pinocchio::JointIndex below = parent < 0 ? 0 : ids[parent];
        const std::string name = "joint" + std::to_string(i);
        ids[i] = model->joint_type[i] == MR_REVOLUTE
                     ? peer.model.addJoint(below, pinocchio::JointModelRZ(), T, name)
                     : peer.model.addJoint(below, pinocchio::JointModelPZ(), T, name);
        peer.order.push_back(i);
    }
    for (int32_t b = 0; b < model->b; ++b) {
        const int32_t i = model->body_joint[b];
        if (i < 0) continue;
        const double *I = nominal->inertia + 6 * b;
        Eigen::Matrix3d inertia;
        inertia << I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5];
        const Eigen::Vector3d com = Eigen::Map<const Eigen::Vector3d>(nominal->com + 3 * b);
        if (model->inertia_about[b] == MR_ABOUT_FRAME)
            inertia -= nominal->mass[b] *
                       (com.squaredNorm() * Eigen::Matrix3d::Identity() - com * com.transpose());
        peer.model.appendBodyToJoint(ids[i], pinocchio::Inertia(nominal->mass[b], com, inertia),
                                     se3(model->after[i]) * se3(model->placement[b]));
    }
    peer.data = std::make_unique<pinocchio::Data>(peer.model);
}

void peer_state(const double *q, const double *v, const double *a) {
    const auto vector = [](const double *x) {
        Eigen::VectorXd out(static_cast<Eigen::Index>(peer.order.size()));
        for (size_t k = 0; k < peer.order.size(); ++k) out[k] = x[peer.order[k]];
        return out;
    };
    peer.q.push_back(vector(q));
    peer.v.push_back(vector(v));
    peer.a.push_back(vector(a));
}

double peer_pass(void) {
    double sum = 0.0;
    for (size_t k = 0; k < peer.q.size(); ++k)
        sum += pinocchio::rnea(peer.model, *peer.data, peer.q[k], peer.v[k], peer.a[k])[0];
    return sum;
}

void peer_torque(int32_t state, double *tau) {
    const size_t s = static_cast<size_t>(state);
    const auto &found = pinocchio::rnea(peer.model, *peer.data, peer.q[s], peer.v[s], peer.a[s]);
    for (size_t k = 0; k < peer.order.size(); ++k) tau[peer.order[k]] = found[k];
}
