// A peer on Fast DDS, the default middleware of ROS 2: it prints what it hears, as CDR made anew by Fast CDR, and drives.
//
//   peer DOMAIN SECONDS SPEED TURN
//
// Lines of output: `TOPIC HEX`. It publishes SPEED and TURN as Twist on /robot_0/cmd_vel and a goal on /goal_pose. With
// the word `silent` as fifth argument it publishes nothing; with `odom` it publishes odometry that follows the commands
// that it hears, until SPEED seconds after the first one that is not zero.

#include <fastcdr/Cdr.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "messagesPubSubTypes.h"

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastdds::rtps;

namespace {

std::mutex printing;

template <typename Message>
void print(const std::string& topic, const Message& message) {
  std::vector<char> memory(Message::getCdrSerializedSize(message) + 64);
  eprosima::fastcdr::FastBuffer buffer(memory.data(), memory.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  std::string text;
  for (std::size_t i = 0; i < cdr.getSerializedDataLength(); ++i) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", static_cast<unsigned char>(memory[i]));
    text += two;
  }
  const std::lock_guard<std::mutex> lock(printing);
  std::printf("%s %s\n", topic.c_str(), text.c_str());
  std::fflush(stdout);
}

template <typename Message>
class Listener : public DataReaderListener {
 public:
  Listener(std::string topic, std::function<void(const Message&)> then) : topic_(std::move(topic)), then_(then) {}
  void on_data_available(DataReader* reader) override {
    Message message;
    SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) {
        print(topic_, message);
        if (then_) then_(message);
      }
    }
  }

 private:
  std::string topic_;
  std::function<void(const Message&)> then_;
};

struct Node {
  DomainParticipant* participant;
  Publisher* publisher;
  Subscriber* subscriber;

  explicit Node(int domain) {
    DomainParticipantQos qos;
    auto loopback = std::make_shared<UDPv4TransportDescriptor>();
    loopback->interfaceWhiteList.push_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(loopback);
    eprosima::fastrtps::rtps::Locator_t own;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(own, 127, 0, 0, 1);
    qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(own);
    for (int index = 0; index < 12; ++index) {
      eprosima::fastrtps::rtps::Locator_t peer;
      eprosima::fastrtps::rtps::IPLocator::setIPv4(peer, 127, 0, 0, 1);
      peer.port = static_cast<uint32_t>(7400 + 250 * domain + 10 + 2 * index);
      qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
    participant = DomainParticipantFactory::get_instance()->create_participant(static_cast<uint32_t>(domain), qos);
    publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }

  template <typename Type>
  Topic* topic(const std::string& name, const std::string& kind) {
    TypeSupport type(new Type());
    type->setName(kind.c_str());
    type.register_type(participant);
    return participant->create_topic("rt" + name, kind, TOPIC_QOS_DEFAULT);
  }

  template <typename Type, typename Message>
  void hear(const std::string& name, const std::string& kind, bool reliable, bool latched,
            std::function<void(const Message&)> then = nullptr) {
    DataReaderQos qos;
    qos.reliability().kind = reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.history().depth = 10;
    subscriber->create_datareader(topic<Type>(name, kind), qos, new Listener<Message>(name, then));
  }

  template <typename Type>
  DataWriter* writer(const std::string& name, const std::string& kind) {
    DataWriterQos qos;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.history().depth = 10;
    return publisher->create_datawriter(topic<Type>(name, kind), qos);
  }
};

}  // namespace

int main(int count, char** words) {
  if (count < 5) return 2;
  const int domain = std::atoi(words[1]);
  const double seconds = std::atof(words[2]), speed = std::atof(words[3]), turn = std::atof(words[4]);
  const std::string mode = count > 5 ? words[5] : "drive";
  namespace geo = geometry_msgs::msg::dds_;
  namespace nav = nav_msgs::msg::dds_;
  const std::string twist = "geometry_msgs::msg::dds_::Twist_", odometry = "nav_msgs::msg::dds_::Odometry_";
  Node node(domain);
  const auto start = std::chrono::steady_clock::now();
  const auto age = [&start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  if (mode == "odom") {
    std::mutex guard;
    double forward = 0, rate = 0, x = 0, y = 0, yaw = 0, last = seconds;
    DataWriter* out = node.writer<nav::Odometry_PubSubType>("/robot_0/odom", odometry);
    node.hear<geo::Twist_PubSubType, geo::Twist_>("/robot_0/cmd_vel", twist, true, false, [&](const geo::Twist_& said) {
      const std::lock_guard<std::mutex> lock(guard);
      forward = said.linear().x();
      rate = said.angular().z();
      if (forward != 0 && last == seconds) last = age() + speed;
    });
    const double period = 0.02;
    while (age() < seconds) {
      nav::Odometry_ message;
      {
        const std::lock_guard<std::mutex> lock(guard);
        x += period * forward * std::cos(yaw);
        y += period * forward * std::sin(yaw);
        yaw += period * rate;
        message.twist().twist().linear().x(forward);
        message.twist().twist().angular().z(rate);
      }
      message.header().frame_id("odom");
      message.child_frame_id("base_link");
      message.pose().pose().position().x(x);
      message.pose().pose().position().y(y);
      message.pose().pose().orientation().z(std::sin(yaw / 2));
      message.pose().pose().orientation().w(std::cos(yaw / 2));
      if (age() < last) out->write(&message);
      std::this_thread::sleep_for(std::chrono::duration<double>(period));
    }
    std::_Exit(0);
  }
  node.hear<nav::Odometry_PubSubType, nav::Odometry_>("/robot_0/odom", odometry, true, false);
  node.hear<geo::PoseStamped_PubSubType, geo::PoseStamped_>("/robot_0/pose", "geometry_msgs::msg::dds_::PoseStamped_",
                                                           true, false);
  node.hear<geo::PoseArray_PubSubType, geo::PoseArray_>("/pedestrians", "geometry_msgs::msg::dds_::PoseArray_", true,
                                                       false);
  node.hear<tf2_msgs::msg::dds_::TFMessage_PubSubType, tf2_msgs::msg::dds_::TFMessage_>(
      "/tf", "tf2_msgs::msg::dds_::TFMessage_", true, false);
  node.hear<sensor_msgs::msg::dds_::LaserScan_PubSubType, sensor_msgs::msg::dds_::LaserScan_>(
      "/robot_0/scan", "sensor_msgs::msg::dds_::LaserScan_", false, false);
  node.hear<nav::OccupancyGrid_PubSubType, nav::OccupancyGrid_>("/map", "nav_msgs::msg::dds_::OccupancyGrid_", true,
                                                               true);
  node.hear<nav::Path_PubSubType, nav::Path_>("/robot_0/reference_path", "nav_msgs::msg::dds_::Path_", true, true);
  node.hear<visualization_msgs::msg::dds_::MarkerArray_PubSubType, visualization_msgs::msg::dds_::MarkerArray_>(
      "/irsim/markers", "visualization_msgs::msg::dds_::MarkerArray_", true, true);
  DataWriter* command = node.writer<geo::Twist_PubSubType>("/robot_0/cmd_vel", twist);
  DataWriter* goal = node.writer<geo::PoseStamped_PubSubType>("/goal_pose", "geometry_msgs::msg::dds_::PoseStamped_");
  geo::Twist_ wanted;
  wanted.linear().x(speed);
  wanted.angular().z(turn);
  geo::PoseStamped_ target;
  target.header().frame_id("map");
  target.pose().position().x(3.0);
  target.pose().position().y(2.0);
  target.pose().orientation().w(1.0);
  while (age() < seconds) {
    if (mode == "drive") {
      command->write(&wanted);
      goal->write(&target);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::_Exit(0);  // without waiting for the threads of the middleware
}
