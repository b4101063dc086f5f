// SPDX-License-Identifier: Apache-2.0
// Asks a running server about its brick: what the next impact does, and in which contact mode the brick lies.
// Start `contact-dynamics server` or `ros2 launch contact_dynamics server.launch.py` first.
//
// The clients' queues are deep and each call has a deadline, because replies can get lost when many ask at once.

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include <contact_dynamics_interfaces/srv/predict_contact_mode.hpp>
#include <contact_dynamics_interfaces/srv/predict_impact.hpp>
#include <rclcpp/rclcpp.hpp>

using contact_dynamics_interfaces::srv::PredictContactMode;
using contact_dynamics_interfaces::srv::PredictImpact;

namespace
{
constexpr std::chrono::seconds kPatience{10};   // for the server to be found
constexpr std::chrono::seconds kDeadline{1};    // for each answer
constexpr int kTries = 3;

// Returns the response, or nothing if none came in time. A request may be asked twice.
template<typename Service>
typename Service::Response::SharedPtr ask(
  const rclcpp::Node::SharedPtr & node, const typename rclcpp::Client<Service>::SharedPtr & client,
  const typename Service::Request::SharedPtr & request)
{
  for (int i = 0; i < kTries && rclcpp::ok(); ++i) {
    auto pending = client->async_send_request(request);
    if (rclcpp::spin_until_future_complete(node, pending, kDeadline) == rclcpp::FutureReturnCode::SUCCESS) {
      return pending.get();
    }
    client->remove_pending_request(pending);
  }
  return nullptr;
}

// Returns whether there is an answer, and says why where there is none.
template<typename Response>
bool is_answered(const char * question, const std::shared_ptr<Response> & response)
{
  if (!response) {
    std::fprintf(stderr, "%s: no answer in %d tries\n", question, kTries);
    return false;
  }
  if (response->status != Response::OK) {
    std::fprintf(
      stderr, "%s: refused with status %d: %s\n", question, response->status, response->message.c_str());
    return false;
  }
  return true;
}

// A brick that is dropped on a corner, from half a metre.
PredictImpact::Request::SharedPtr dropped()
{
  auto request = std::make_shared<PredictImpact::Request>();
  request->body_name = "brick";
  request->state_source = PredictImpact::Request::STATE_EXPLICIT;
  request->state.pose.position.z = 0.5;
  request->state.pose.orientation.x = 0.28;
  request->state.pose.orientation.y = 0.28;
  request->state.pose.orientation.z = 0.1;
  request->state.pose.orientation.w = 0.9131265;
  request->horizon = {1.5};  // a number that may be left out is a list of at most one
  return request;
}

// A brick that lies flat and is pushed along x.
PredictContactMode::Request::SharedPtr pushed()
{
  auto request = std::make_shared<PredictContactMode::Request>();
  request->body_name = "brick";
  request->state_source = PredictContactMode::Request::STATE_EXPLICIT;
  request->state.pose.position.z = 0.025;
  request->applied_wrench.force.x = 2.0;
  request->plane_normal.y = -1.0;
  request->include_margins = true;
  return request;
}
}  // namespace

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("asks_the_server");
  const auto queue = rclcpp::ServicesQoS().keep_last(1000);
  auto impact = node->create_client<PredictImpact>("contact_dynamics/predict_impact", queue);
  auto modes = node->create_client<PredictContactMode>("contact_dynamics/predict_contact_mode", queue);
  if (!impact->wait_for_service(kPatience) || !modes->wait_for_service(kPatience)) {
    std::fprintf(stderr, "no server: start it with `contact-dynamics server`\n");
    return 1;
  }

  const auto struck = ask<PredictImpact>(node, impact, dropped());
  if (!is_answered("predict_impact", struck)) {
    return 1;
  }
  const auto & after = struck->impact.state_after.linear_velocity;
  std::printf(
    "lands in %.3f s on %s, and leaves with (%.3f, %.3f, %.3f) m/s\n", struck->time_to_contact,
    struck->contacts.surface_names.front().c_str(), after.x, after.y, after.z);

  const auto lying = ask<PredictContactMode>(node, modes, pushed());
  if (!is_answered("predict_contact_mode", lying)) {
    return 1;
  }
  for (const auto & mode : lying->modes) {
    std::printf("pushed with 2 N: mode %s, %.3f N from another\n", mode.mode.c_str(), mode.margin);
  }
  rclcpp::shutdown();
  return 0;
}
