// The benchmarks s1 and s2 of `motehound bench` in ns-3's lr-wpan (release 3.44), beside which docs/scale.md puts them.
//
//     ns3_bench s1|s2 NODES SEED BYTES
//
// The same motes at the same places, the same propagation and the same traffic. Whatever makes ns-3 quicker is done for it: the channel drops what
// arrives too weak to be received or to disturb (without MaxLossDb it takes four times as long), and in s2 nothing is spent on routing: each mote knows its next hop from
// the start. Prints one line of JSON.
#include <ns3/constant-position-mobility-model.h>
#include <ns3/core-module.h>
#include <ns3/lr-wpan-module.h>
#include <ns3/mobility-helper.h>
#include <ns3/network-module.h>
#include <ns3/propagation-module.h>
#include <ns3/single-model-spectrum-channel.h>

#include <cmath>
#include <ctime>
#include <iostream>
#include <sys/resource.h>
#include <vector>

using namespace ns3;
using lrwpan::LrWpanNetDevice;

namespace
{

constexpr double SPACING_M = 30, JITTER = 0.3, EXPONENT = 3, REFERENCE_LOSS_DB = 46.68;
constexpr double MAX_LOSS_DB = 113; // lr-wpan receives frames that have lost up to 108 dB (its standard sensitivity), 39 motes each
constexpr double INTERVAL_S = 10, RUN_S = 100;
constexpr size_t SOURCES = 20;
constexpr double HOP_M = 80; // longest hop of s2; at 100 m frames are lost to noise

// SplitMix64, as host_sim/engine/random.h.
double Uniform(uint64_t seed, uint64_t counter)
{
    uint64_t z = seed + (counter + 1) * UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

struct Place
{
    double x, y;
};

struct Mote
{
    Ptr<LrWpanNetDevice> device;
    Mac16Address next; // towards the sink
};

struct Bench
{
    std::vector<Mote> motes;
    size_t sink = 0;
    bool unicast = false;
    uint32_t bytes = 0;
    uint64_t transmissions = 0, receptions = 0, delivered = 0;

    void Send(size_t mote)
    {
        lrwpan::McpsDataRequestParams params;
        params.m_dstPanId = 10;
        params.m_dstAddr = unicast ? motes[mote].next : Mac16Address("ff:ff");
        params.m_txOptions = unicast ? lrwpan::TX_OPTION_ACK : lrwpan::TX_OPTION_NONE;
        motes[mote].device->GetMac()->McpsDataRequest(params, Create<Packet>(bytes));
    }

    void Report(size_t mote)
    {
        Send(mote);
        Simulator::Schedule(Seconds(INTERVAL_S), &Bench::Report, this, mote);
    }

    void Heard(size_t mote, lrwpan::McpsDataIndicationParams, Ptr<Packet>)
    {
        receptions++;
        if (unicast)
        {
            mote == sink ? void(delivered++) : Send(mote);
        }
    }

    void OnAir(Ptr<const Packet>) { transmissions++; }
};

// Fewest hops to the sink, breadth first.
std::vector<size_t> NextHops(const std::vector<Place>& places, size_t sink, double hop_m)
{
    std::vector<size_t> next(places.size(), sink), queue{sink};
    std::vector<bool> reached(places.size());
    reached[sink] = true;
    for (size_t at = 0; at < queue.size(); at++)
    {
        for (size_t i = 0; i < places.size(); i++)
        {
            const Place &a = places[queue[at]], &b = places[i];
            if (!reached[i] && std::hypot(a.x - b.x, a.y - b.y) <= hop_m)
            {
                reached[i] = true;
                next[i] = queue[at];
                queue.push_back(i);
            }
        }
    }
    return next;
}

double CpuSeconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

} // namespace

int main(int argc, char** argv)
{
    if (argc != 5)
    {
        std::cerr << "ns3_bench s1|s2 NODES SEED BYTES\n";
        return 1;
    }
    const std::string name = argv[1];
    const size_t nodes = std::stoul(argv[2]);
    const uint64_t seed = std::stoull(argv[3]);
    const auto columns = size_t(std::ceil(std::sqrt(double(nodes))));
    RngSeedManager::SetSeed(uint32_t(seed) + 1);

    static Bench bench;
    bench.unicast = name == "s2";
    bench.bytes = uint32_t(std::stoul(argv[4]));
    std::vector<Place> places;
    auto positions = CreateObject<ListPositionAllocator>();
    for (size_t i = 0; i < nodes; i++)
    {
        places.push_back({SPACING_M * (double(i % columns) + 0.5 + JITTER * (2 * Uniform(seed, 2 * i) - 1)),
                          SPACING_M * (double(i / columns) + 0.5 + JITTER * (2 * Uniform(seed, 2 * i + 1) - 1))});
    }
    if (bench.unicast) // the sink, in the middle
    {
        bench.sink = nodes;
        places.push_back({SPACING_M * double(columns) / 2, SPACING_M * double(columns) / 2});
    }
    for (const Place& place : places)
    {
        positions->Add(Vector(place.x, place.y, 0));
    }

    NodeContainer motes;
    motes.Create(uint32_t(places.size()));
    MobilityHelper mobility;
    mobility.SetPositionAllocator(positions);
    mobility.SetMobilityModel("ns3::ConstantPositionMobilityModel");
    mobility.Install(motes);

    auto channel = CreateObject<SingleModelSpectrumChannel>();
    auto loss = CreateObject<LogDistancePropagationLossModel>();
    loss->SetPathLossExponent(EXPONENT);
    loss->SetReference(1, REFERENCE_LOSS_DB);
    channel->AddPropagationLossModel(loss);
    channel->SetAttribute("MaxLossDb", DoubleValue(MAX_LOSS_DB));
    channel->SetPropagationDelayModel(CreateObject<ConstantSpeedPropagationDelayModel>());
    LrWpanHelper helper;
    helper.SetChannel(channel);
    NetDeviceContainer devices = helper.Install(motes);
    helper.CreateAssociatedPan(devices, 10);

    std::vector<size_t> next;
    if (bench.unicast)
    {
        next = NextHops(places, bench.sink, HOP_M);
    }
    for (size_t i = 0; i < places.size(); i++)
    {
        Mote mote;
        mote.device = DynamicCast<LrWpanNetDevice>(devices.Get(uint32_t(i)));
        if (bench.unicast)
        {
            mote.next = DynamicCast<LrWpanNetDevice>(devices.Get(uint32_t(next[i])))->GetMac()->GetShortAddress();
        }
        mote.device->GetMac()->SetMcpsDataIndicationCallback(MakeCallback(&Bench::Heard, &bench).Bind(i));
        mote.device->GetMac()->TraceConnectWithoutContext("MacTx", MakeCallback(&Bench::OnAir, &bench));
        bench.motes.push_back(mote);
    }
    for (size_t i = 0; i < nodes; i++)
    {
        const bool reports = !bench.unicast || (i + 1) * SOURCES / nodes > i * SOURCES / nodes;
        if (reports)
        {
            Simulator::Schedule(Seconds(INTERVAL_S * Uniform(seed, 1000000 + i)), &Bench::Report, &bench, i);
        }
    }
    const double made_s = CpuSeconds();
    Simulator::Stop(Seconds(RUN_S));
    Simulator::Run();
    const double cpu_s = CpuSeconds() - made_s;
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::cout << "{\"name\": \"" << name << "\", \"n\": " << nodes << ", \"cpu_s\": " << cpu_s << ", \"set_up_s\": " << made_s
              << ", \"events\": " << Simulator::GetEventCount() << ", \"transmissions\": " << bench.transmissions
              << ", \"receptions\": " << bench.receptions << ", \"delivered\": " << bench.delivered
              << ", \"peak_rss\": " << usage.ru_maxrss * 1024L << "}" << std::endl;
    Simulator::Destroy();
    return 0;
}
