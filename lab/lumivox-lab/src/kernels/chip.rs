//! A GPU that is not there: RADV, Mesa's driver for AMD, compiles for any chip of a name that it
//! gets in `RADV_FORCE_FAMILY`, and has figures of the result: registers, waves, instructions
//! (`VK_KHR_pipeline_executable_properties`).

#![allow(unsafe_code, reason = "Vulkan's own interface: wgpu does not open such a device")]

use std::ffi::CStr;

use anyhow::Context as _;
use ash::vk;
use naga::AddressSpace;
use serde::{Deserialize, Serialize};

/// Makes the driver keep the figures of a pipeline.
const STATISTICS: vk::PipelineCreateFlags = vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR;

/// Figures of a compiled kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Compiled {
    /// Vector registers of an invocation.
    pub registers: u64,
    /// Waves that a SIMD unit holds at once; at most 32 on navi21, 10 on vega10.
    pub waves: u64,
    /// Registers that are kept in memory instead.
    pub spilled: u64,
    pub instructions: u64,
}

/// The driver, opened for the chip of the environment. It can create pipelines, but run nothing.
pub struct Chip {
    device: ash::Device,
    statistics: ash::khr::pipeline_executable_properties::Device,
    /// Chip and driver, such as "RADV NAVI21, Mesa 22.3.6".
    pub name: String,
    // Dropped last: the device's functions are in the loaded library.
    _instance: ash::Instance,
    _entry: ash::Entry,
}

impl Chip {
    /// # Errors
    /// When there is no Vulkan loader, or no such driver.
    pub fn open() -> anyhow::Result<Self> {
        // SAFETY: the handles are used in the order of Vulkan's specification, and the structures
        // live as long as the calls that read them. Nothing is destroyed before the process ends.
        unsafe {
            let entry = ash::Entry::load().context("no Vulkan loader (Debian: libvulkan1)")?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
            let create = vk::InstanceCreateInfo::default().application_info(&application);
            let instance = entry.create_instance(&create, None).context("no RADV")?;
            let chips = instance.enumerate_physical_devices()?;
            let chip = *chips.first().context("RADV knows no such chip")?;
            let mut driver = vk::PhysicalDeviceDriverProperties::default();
            let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
            instance.get_physical_device_properties2(chip, &mut properties);
            let device_name = properties.properties.device_name;
            let name = format!("{}, {}", text(&device_name), text(&driver.driver_info));
            let mut feature = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
                .pipeline_executable_info(true);
            let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&[1.0])];
            let extensions = [ash::khr::pipeline_executable_properties::NAME.as_ptr()];
            let create = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_extension_names(&extensions)
                .push_next(&mut feature);
            let device = instance.create_device(chip, &create, None)?;
            let statistics =
                ash::khr::pipeline_executable_properties::Device::new(&instance, &device);
            Ok(Self { device, statistics, name, _instance: instance, _entry: entry })
        }
    }

    /// Compiles an entry point of a WGSL module.
    ///
    /// # Errors
    /// When the module is not valid, or the driver refuses it.
    pub fn compile(&self, wgsl: &str, entry: &str) -> anyhow::Result<Compiled> {
        let module = naga::front::wgsl::parse_str(wgsl)?;
        let flags = naga::valid::ValidationFlags::all();
        let info = naga::valid::Validator::new(flags, naga::valid::Capabilities::all())
            .validate(&module)?;
        let stage = naga::ShaderStage::Compute;
        let only =
            naga::back::spv::PipelineOptions { shader_stage: stage, entry_point: entry.to_owned() };
        let options = naga::back::spv::Options::default();
        let code = naga::back::spv::write_vec(&module, &info, &options, Some(&only))?;
        let entry = std::ffi::CString::new(entry)?;
        // SAFETY: as in `open`.
        unsafe {
            let layouts: Vec<_> = groups(&module)
                .iter()
                .map(|bindings| {
                    let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(bindings);
                    self.device.create_descriptor_set_layout(&create, None)
                })
                .collect::<Result<_, _>>()?;
            let create = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
            let layout = self.device.create_pipeline_layout(&create, None)?;
            let create = vk::ShaderModuleCreateInfo::default().code(&code);
            let shader = self.device.create_shader_module(&create, None)?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(shader)
                .name(&entry);
            let create = vk::ComputePipelineCreateInfo::default()
                .flags(STATISTICS)
                .stage(stage)
                .layout(layout);
            let created =
                self.device.create_compute_pipelines(vk::PipelineCache::null(), &[create], None);
            let pipelines = created.map_err(|(_, error)| error)?;
            let of = vk::PipelineExecutableInfoKHR::default().pipeline(pipelines[0]);
            let statistics = self.statistics.get_pipeline_executable_statistics(&of)?;
            let value = |name: &str| {
                let found = statistics.iter().find(|one| text(&one.name) == name);
                found.map_or(0, |one| one.value.u64)
            };
            Ok(Compiled {
                registers: value("VGPRs"),
                waves: value("Subgroups per SIMD"),
                spilled: value("Spilled VGPRs"),
                instructions: value("Instructions"),
            })
        }
    }
}

/// The text of a fixed array with a zero at its end.
fn text(chars: &[std::ffi::c_char]) -> String {
    let bytes: Vec<u8> = chars.iter().map(|char| char.cast_unsigned()).collect();
    CStr::from_bytes_until_nul(&bytes).unwrap_or_default().to_string_lossy().into_owned()
}

/// The bindings of each group of a module.
fn groups(module: &naga::Module) -> Vec<Vec<vk::DescriptorSetLayoutBinding<'static>>> {
    let mut groups = Vec::new();
    for (_, variable) in module.global_variables.iter() {
        let Some(place) = variable.binding else { continue };
        let kind = match (variable.space, &module.types[variable.ty].inner) {
            (AddressSpace::Uniform, _) => vk::DescriptorType::UNIFORM_BUFFER,
            (AddressSpace::Storage { .. }, _) => vk::DescriptorType::STORAGE_BUFFER,
            (_, naga::TypeInner::Sampler { .. }) => vk::DescriptorType::SAMPLER,
            (_, naga::TypeInner::Image { class: naga::ImageClass::Storage { .. }, .. }) => {
                vk::DescriptorType::STORAGE_IMAGE
            }
            _ => vk::DescriptorType::SAMPLED_IMAGE,
        };
        let group = place.group as usize;
        groups.resize_with(groups.len().max(group + 1), Vec::new);
        groups[group].push(
            vk::DescriptorSetLayoutBinding::default()
                .binding(place.binding)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE),
        );
    }
    groups
}
